# The simulator dies and comes back: with it the pace of the system, and the robot, begin anew. The next task is done.
start give_mug seed 12
wait ready within 15s
kill sim
expect back sim within 5s
expect mode normal within 5s
task give mug
expect task done within 70s
expect no limit violations
expect no collisions
stop
