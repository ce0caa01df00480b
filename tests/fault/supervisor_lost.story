# The supervisor dies: the running trajectory is finished, then Hold; it comes back.
start give_mug seed 8
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
kill -9 supervisor
expect cause supervisor_silent within 450ms
expect status names supervisor within 1s
expect rest within 8s
expect back supervisor within 2s
expect no limit violations
stop
