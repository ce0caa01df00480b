# A robot that drives fetches a mug and gives it to a person on the other side of the room.
start fetch_mug seed 1
wait ready within 15s
task give mug to anna
wait carrier robot within 40s
wait handover within 90s
wait task done within 25s
expect nothing dropped
expect no limit violations
expect no separation violations
stop
