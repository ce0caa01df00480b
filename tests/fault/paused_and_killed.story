# Paused, then every process that keeps the pause dies: the arm stands until somebody resumes, then the task goes to its end.
start give_mug seed 31
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
pause
expect rest within 3s
kill -9 trajectory_controller
expect back trajectory_controller within 3s
listen for 2s
expect rest
kill -9 spark
expect back spark within 3s
listen for 2s
expect rest
expect cause awaits_person
kill -9 supervisor
expect back supervisor within 3s
listen for 2s
expect rest
resume
expect moving within 8s
expect task done within 90s
expect handover
expect no limit violations
expect no separation violations
stop
