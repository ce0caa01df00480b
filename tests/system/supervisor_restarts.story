# The supervisor dies in the middle of a task: the goal is sent again, the new one takes over what runs, and the task is done.
start give_mug seed 31
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
kill -9 supervisor
expect back supervisor within 3s
expect task done within 90s
expect handover
expect nothing dropped
expect no limit violations
stop
