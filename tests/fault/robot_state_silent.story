# RobotState stays away: Stop after 20 ms; moving again after a new Go once it is back.
start give_mug seed 4
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
sim silence_robot_state 1.0
expect mode stop within 80ms
expect cause robot_state_silent within 80ms
expect rest within 700ms
expect status names robot_state_silent within 1s
expect mode normal within 5s
expect no limit violations
stop
