# Two tasks without a person: the mug is picked up, then put down again.
start give_mug seed 28
wait ready within 15s
task pick mug
expect carrier robot within 50s
expect task done within 60s
task place mug on table
expect carrier surface within 60s
expect task done within 70s
expect nothing dropped
expect no limit violations
stop
