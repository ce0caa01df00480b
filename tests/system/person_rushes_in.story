# The person rushes at the moving arm: it slows or stands before they meet, then hands over all the same.
start give_mug seed 26
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
sim person_dart anna 1.6
expect cause separation within 2s
expect no separation violations
expect no collisions
expect task done within 80s
expect nothing dropped
expect no separation violations
expect no limit violations
stop
