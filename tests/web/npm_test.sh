#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# npm_test.sh SCRIPT ARGUMENTS...: fetches the tests' npm packages when package-lock.json has changed, then runs the script.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here"
(
  flock 9  # one of several tests fetches
  wanted=$(sha256sum package-lock.json)
  if [ "$(cat node_modules/.lock 2>/dev/null)" != "$wanted" ]; then
    npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
    echo "$wanted" > node_modules/.lock
  fi
) 9>"${TMPDIR:-/tmp}/handsel-npm-$(id -u).lock"
exec node "$@"
