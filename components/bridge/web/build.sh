#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# build.sh <folder> [--test]: the page, bundled into <folder>, when a source is newer than what is there. --test also installs what its tests need.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
case $1 in /*) folder=$1 ;; *) folder=$PWD/$1 ;; esac
cd "$here"

wanted="--omit=dev"
[ "${2:-}" != --test ] || wanted="--include=dev"
installed=node_modules/.installed
# shellcheck disable=SC3013 # dash, bash and busybox compare ages with -nt
if [ ! -f $installed ] || [ package-lock.json -nt $installed ] || { [ "${2:-}" = --test ] && [ "$(cat $installed)" != "$wanted" ]; }; then
  echo "page: fetching its packages" >&2
  npm ci "$wanted" --ignore-scripts --no-audit --no-fund --loglevel=error >&2
  echo "$wanted" > $installed
fi
if [ ! -f "$folder/page.js" ] || [ -n "$(find src build.mjs build.sh package-lock.json -newer "$folder/page.js")" ]; then
  echo "page: bundling" >&2
  rm -rf "$folder.new"
  node build.mjs "$folder.new"
  rm -rf "$folder"
  mv "$folder.new" "$folder"
fi
