#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# build.sh [target...]: sets up, configures build/release when needed, builds the targets ("all" when none is named) and the page.
# "all" also sets up what the tests need.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
for_tests=""
[ "${1:-all}" != all ] || for_tests=--test
"$root/deploy/setup.sh" $for_tests
cd "$root"
if [ ! -f build/release/build.ninja ]; then
  launcher=""
  if command -v ccache >/dev/null 2>&1; then
    launcher="-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache"
  fi
  # shellcheck disable=SC2086 # two options or none
  cmake --preset release $launcher >&2
fi
# Objects are the same wherever the tree lies, precompiled headers included.
export CCACHE_BASEDIR="${CCACHE_BASEDIR:-$root}" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS="${CCACHE_SLOPPINESS:-pch_defines,time_macros}"
cmake --build build/release --target "${@:-all}" >&2
# The system runs without its page, and so do all tests but those of the page, which fail.
"$root/components/bridge/web/build.sh" "$root/build/release/web" $for_tests ||
  echo "build: the page could not be built (are the npm packages within reach?); the system runs without it" >&2
