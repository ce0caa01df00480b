# A word from the operator: the arm stops softly where it is, waits as long as it is told to, and goes on.
start give_mug seed 21
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
pause
expect task paused within 3s
expect rest within 3s
listen for 2s
expect rest
resume
expect moving within 5s
expect task done within 70s
expect handover
expect no limit violations
stop
