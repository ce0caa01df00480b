# The main job: a mug goes from the table into a person's hand.
start give_mug seed 1
wait ready within 15s
task give mug
wait moving within 10s
wait carrier robot within 40s
wait handover within 60s
expect task done within 70s
expect one commander
expect nothing dropped
expect no limit violations
expect no separation violations
stop
