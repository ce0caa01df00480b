# A robot with two arms hands a tray that is too heavy for one hand to a person, who takes it with both hands.
start give_tray seed 2
wait ready within 30s
task give tray to anna
wait carrier robot within 90s
expect hand hand within 90s
expect hand left_hand within 90s
expect carrier human within 120s
expect task done within 200s
expect nothing dropped
expect no limit violations
expect no separation violations
stop
