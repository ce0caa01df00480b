# Two planners die at once while the arm moves: both come back, and the person gets the mug.
start give_mug seed 29
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
kill -9 path_planner trajectory_planner
expect back path_planner within 5s
expect back trajectory_planner within 5s
expect task done within 80s
expect handover
expect no limit violations
stop
