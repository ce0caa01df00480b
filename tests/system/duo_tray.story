# A robot with two arms carries with both hands a tray that is too heavy for one.
start duo_tray seed 2
wait ready within 15s
task place tray on stand
wait carrier robot within 90s
expect hand hand within 90s
expect hand left_hand within 90s
expect carrier surface within 120s
expect task done within 130s
expect nothing dropped
expect no limit violations
expect no separation violations
stop
