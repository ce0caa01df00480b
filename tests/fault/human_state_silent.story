# SPARK hangs: HumanState is old after 200 ms and the arm stops; it goes on when SPARK is back.
start give_mug seed 5
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
silence spark for 1500ms
expect mode stop within 350ms
expect cause human_state_silent within 350ms
expect rest within 1s
expect status names spark within 1s
expect back spark within 3500ms
expect task done within 70s
expect handover
expect no limit violations
stop
