# After the main job the person holds the mug. Asked for it, the person hands it back; the robot puts it down and gives it again.
start back_and_forth seed 4
wait ready within 15s
task give mug
expect task done within 70s
expect carrier human
task receive mug
wait carrier both within 60s
expect carrier surface within 70s
expect task done within 80s
task give mug
expect task done within 70s
expect carrier human
expect nothing dropped
expect no limit violations
expect no separation violations
stop
