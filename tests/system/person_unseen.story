# The sensors see nobody any more while the arm moves near where somebody was: it stops, says why, and goes on when they see again.
start give_mug seed 23
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
sim silence_human 2.0
expect mode slow within 500ms
expect status names kinect within 1s
expect rest within 1500ms
expect mode normal within 6s
expect task done within 70s
expect handover
expect no separation violations
expect no limit violations
stop
