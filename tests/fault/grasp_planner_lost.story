# The grasp_planner dies while the arm moves: the validated trajectory is finished, the process comes back, the task is done.
start give_mug seed 9
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
kill -9 grasp_planner
expect status names grasp_planner within 1s
expect back grasp_planner within 5s
expect task done within 80s
expect handover
expect no limit violations
stop
