# The wall screen dies: nothing.
start give_mug seed 11
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
kill -9 bridge
never mode stop for 2s
expect back bridge within 2s
expect task done within 70s
expect handover
expect no limit violations
stop
