# A fault, a stop of the robot's own protection and a slow speed outlive the processes that know of them; only a person ends each.
start give_mug seed 32
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
speed 10
expect speed below 0.11 within 2s
kill -9 supervisor
expect back supervisor within 3s
listen for 2s
expect speed below 0.11
expect moving
speed 100
listen for 1s
sim robot_stop protective
expect rest within 1s
expect cause awaits_person within 1s
kill -9 trajectory_controller
expect back trajectory_controller within 3s
listen for 2s
expect rest
resume
expect moving within 8s
listen for 500ms
sim robot_stop unannounced
expect mode fault within 5s
expect rest within 6s
kill -9 trajectory_controller
expect back trajectory_controller within 3s
kill -9 supervisor
expect back supervisor within 3s
listen for 2s
expect rest
expect cause awaits_person
resume
listen for 1s
expect rest
acknowledge
expect moving within 8s
expect no limit violations
expect no separation violations
stop
