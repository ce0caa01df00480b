# What is to be lifted is picked up and stays in the hand.
start give_mug_still seed 2
wait ready within 15s
task lift mug
expect task done within 60s
listen for 2s
expect carrier robot
expect hand hand
expect nothing dropped
expect no limit violations
expect no separation violations
stop
