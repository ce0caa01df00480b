# A robot with two arms receives a mug with its left hand and puts it where only the right arm reaches.
start duo_left seed 4
wait ready within 15s
task give mug to anna
wait carrier human within 70s
expect task done within 80s
task receive mug from anna on shelf
wait carrier both within 60s
expect hand left_hand within 60s
wait hand hand within 120s
expect carrier surface within 120s
expect task done within 130s
expect nothing dropped
expect no limit violations
expect no separation violations
stop
