# A robot with two arms gives and takes with the arm that is nearer: the left one.
start duo_left seed 4
wait ready within 15s
task give mug to anna
wait hand left_hand within 40s
expect task done within 70s
expect carrier human
task receive mug from anna on table
wait carrier both within 60s
expect hand left_hand within 60s
expect carrier surface within 80s
expect task done within 90s
expect nothing dropped
expect no limit violations
expect no separation violations
stop
