# A third of the speed, for as long as somebody wants it.
start give_mug seed 24
wait ready within 15s
speed 30
task give mug
wait moving within 20s
expect cause override_slow within 5s
expect speed below 0.31 within 5s
expect task done within 120s
expect handover
expect no limit violations
stop
