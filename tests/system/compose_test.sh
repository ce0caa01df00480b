#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# compose_test.sh: the deployment with a container engine, as docs/deploy.md describes it: the image is built, the compose file brought up on
# a bridge network, a mug handed over, a process killed and back, everything taken down. Prints size and times. Exit 77: no engine here.
#   HANDSEL_TEST_IMAGE     an image that is there already: nothing is built
#   HANDSEL_BUILD_OPTIONS  more options of `podman build`, e.g. --build-arg TREE=installed
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
project=handsel-test-$$
compose_file=$root/deploy/docker-compose.yml
export HANDSEL_IMAGE="${HANDSEL_TEST_IMAGE:-localhost/handsel-test}" HANDSEL_WEB_PORT="${HANDSEL_WEB_PORT:-8799}"

if docker info >/dev/null 2>&1 && docker compose version >/dev/null 2>&1; then
  engine=docker compose="docker compose"
elif command -v podman >/dev/null 2>&1 && podman info >/dev/null 2>&1 && command -v podman-compose >/dev/null 2>&1; then
  engine=podman compose=podman-compose
else
  echo "left out: neither docker with compose nor podman with podman-compose works here"
  exit 77
fi

now() { date +%s.%N; }
since() { awk -v begin="$1" -v end="$(now)" 'BEGIN { printf "%.1f", end - begin }'; }
fail() {
  echo "failed: $*"
  exit 1
}
container() {
  $engine ps -a -q --filter "label=com.docker.compose.project=$project" --filter "label=com.docker.compose.service=$1"
}
in_service() {
  service=$1
  shift
  $engine exec "$(container "$service")" "$@"
}
down() { $compose -p "$project" -f "$compose_file" down -t 3 >/dev/null 2>&1 || true; }
trap down EXIT INT TERM

if [ -z "${HANDSEL_TEST_IMAGE:-}" ]; then
  begin=$(now)
  # shellcheck disable=SC2086 # options, not one word
  $engine build --build-arg TREE=build ${HANDSEL_BUILD_OPTIONS:-} -t "$HANDSEL_IMAGE" -f "$root/deploy/Dockerfile" "$root" || fail "the image was not built"
  echo "image built in $(since "$begin") s"
fi
size=$($engine image inspect --format '{{.Size}}' "$HANDSEL_IMAGE")
echo "image size $((size / 1000000)) MB"
[ "$size" -lt 400000000 ] || fail "the image is larger than 400 MB"

begin=$(now)
$compose -p "$project" -f "$compose_file" up -d >/dev/null 2>&1 || fail "compose up"
started=$(now)
in_service supervisor handsel health --within 30 || fail "not ready: $(in_service supervisor handsel status)"
echo "ready $(since "$begin") s after compose up began, $(since "$started") s after its last container had started"

services=$(sed -n 's/^  \([a-z_]*\):$/\1/p' "$compose_file")
count=$(echo "$services" | wc -l)
addresses=$(for service in $services; do
  $engine inspect --format '{{range .NetworkSettings.Networks}}{{.IPAddress}} {{end}}' "$(container "$service")"
done | sort -u)
echo "$count services at $(echo "$addresses" | wc -l) addresses"
[ "$(echo "$addresses" | wc -l)" -eq "$count" ] || fail "services share addresses"
for service in $services; do
  in_service "$service" handsel health "$service" >/dev/null || fail "the health check of $service"
done
[ "$(in_service supervisor id -u)" -ne 0 ] || fail "runs as root"
! in_service supervisor touch /opt/handsel/x 2>/dev/null || fail "the root is writable"

begin=$(now)
in_service supervisor handsel task give mug || fail "the mug was not handed over"
in_service supervisor handsel topic echo ground_truth --count 1 | grep -q '"handover_done": *true' || fail "the oracle saw no handover"
echo "handed over in $(since "$begin") s"

path_planner=$(container path_planner)
kill -9 "$($engine inspect --format '{{.State.Pid}}' "$path_planner")"
begin=$(now)
deadline=$(($(date +%s) + 20))
until [ "$($engine inspect --format '{{.State.Running}}' "$path_planner")" = true ] && in_service path_planner handsel health path_planner >/dev/null 2>&1; do
  [ "$(date +%s)" -lt "$deadline" ] || fail "path_planner did not come back"
done
echo "path_planner killed, back and ok after $(since "$begin") s"
in_service supervisor handsel health --within 5 || fail "not whole again"

begin=$(now)
down
[ -z "$($engine ps -a -q --filter "label=com.docker.compose.project=$project")" ] || fail "containers are left"
echo "down in $(since "$begin") s"
