# The collision checker hangs: Hold after 100 ms; a new Go resumes.
start give_mug seed 6
wait ready within 15s
task give mug
wait phase approach within 30s
wait moving within 5s
listen for 500ms
silence collision_checker for 1500ms
expect mode hold within 250ms
expect cause forecast_silent within 250ms
expect rest within 1s
expect status names collision_checker within 1s
expect back collision_checker within 3500ms
expect task done within 70s
expect no limit violations
stop
