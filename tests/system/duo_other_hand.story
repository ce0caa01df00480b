# A robot with two arms takes a mug in one hand, then in the other, and tidies it away.
start duo_left seed 4
wait ready within 15s
task regrasp mug
expect task done within 90s
expect carrier robot
task tidy mug on shelf
expect carrier surface within 70s
expect task done within 80s
expect nothing dropped
expect no limit violations
expect no separation violations
stop
