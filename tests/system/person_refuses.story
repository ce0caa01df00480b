# The person does not want the mug: the robot offers, waits, keeps hold of it and says that nobody took it.
start give_mug seed 27
wait ready within 15s
sim person_refuse anna
task give mug
wait phase offer within 60s
expect task failed within 80s
expect nothing dropped
listen for 3s
expect rest
expect no limit violations
stop
