# Somebody presses the robot's stop: the arm stands, also when the robot is enabled again and the supervisor dies, until a person resumes.
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
expect cause awaits_person within 1s
kill -9 supervisor
expect back supervisor within 3s
listen for 2s
expect rest
expect cause awaits_person
resume
expect mode normal within 5s
expect task done within 70s
expect handover
expect no limit violations
stop
