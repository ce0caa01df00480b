# The manipulation planner dies while the arm moves: the trajectory is finished; the task ends with a reason.
start give_mug seed 10
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
kill -9 manipulation_planner
expect status names manipulation_planner within 1s
expect back manipulation_planner within 5s
expect rest within 10s
expect no limit violations
stop
