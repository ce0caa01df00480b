# Somebody presses the robot's stop: the arm stands, and moves again only when the robot is enabled and a person has said so.
start give_mug seed 25
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
sim robot_stop
expect rest within 1s
expect mode stop within 500ms
expect cause drive_not_enabled within 500ms
listen for 1s
expect rest
sim robot_enable
acknowledge
expect mode normal within 5s
expect task done within 70s
expect handover
expect no limit violations
stop
