# Set-points stop: the robot side stops softly by itself within 20 ms and the shortest stop; the controller comes back.
start give_mug seed 2
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
kill -9 trajectory_controller
expect rest within 700ms
expect status names trajectory_controller within 1s
expect back trajectory_controller within 2s
expect no limit violations
stop
