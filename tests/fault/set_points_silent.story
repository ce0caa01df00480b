# The controller hangs: the robot side stops; when it wakes it does not jump.
start give_mug seed 3
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
silence trajectory_controller for 1500ms
expect rest within 700ms
expect status names trajectory_controller within 1s
expect back trajectory_controller within 3500ms
listen for 500ms
expect no limit violations
stop
