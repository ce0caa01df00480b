# The controller is late when the person takes hold and again while the hand opens: the hand still opens all the way.
start give_mug seed 4
wait ready within 15s
task give mug
wait carrier both within 40s
silence trajectory_controller for 100ms
expect mode stop within 500ms
expect mode normal within 2s
wait carrier human within 10s
silence trajectory_controller for 100ms
expect mode stop within 500ms
expect mode normal within 2s
expect handover within 10s
expect task done within 20s
expect nothing dropped
stop
