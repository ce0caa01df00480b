#!/bin/sh
# build.sh [target...]: sets up, configures build/release when needed and builds the targets ("all" when none is named).
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
"$root/deploy/setup.sh"
cd "$root"
if [ ! -f build/release/build.ninja ]; then
  launcher=""
  if command -v ccache >/dev/null 2>&1; then
    launcher="-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache"
  fi
  # shellcheck disable=SC2086 # two options or none
  cmake --preset release $launcher >&2
fi
cmake --build build/release --target "${@:-all}" >&2
