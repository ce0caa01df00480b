#!/bin/sh
# decode_test.sh SAMPLES BRIDGE [DOMAIN [SEED...]]: fetches the test's npm packages when package-lock.json has changed, then runs it.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here"
wanted=$(sha256sum package-lock.json)
if [ "$(cat node_modules/.lock 2>/dev/null)" != "$wanted" ]; then
  npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
  echo "$wanted" > node_modules/.lock
fi
exec node decode_test.mjs "$@"
