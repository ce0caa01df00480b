# Somebody changes their mind: the task ends where it is, nothing falls, and the next one is done as if nothing had been.
start give_mug seed 22
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
cancel
expect task cancelled within 5s
expect rest within 5s
expect nothing dropped
task give mug
expect task done within 80s
expect handover
expect no limit violations
stop
