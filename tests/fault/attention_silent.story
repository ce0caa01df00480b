# The attentional system hangs: a fixed low speed after 300 ms, no stop; the guard stands.
start give_mug seed 7
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
silence attention for 1500ms
expect cause attention_silent within 450ms
expect speed below 0.5 within 1200ms
expect status names attention within 1s
expect back attention within 3500ms
expect task done within 70s
expect no limit violations
stop
