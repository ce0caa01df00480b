#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# setup.sh [--test]: installs the Debian 12 packages Handsel is built from and runs on, with --test also what only its tests need.
# Does nothing when they are all there.
set -eu

packages="
cmake ninja-build g++ pkg-config
cyclonedds-dev cyclonedds-tools protobuf-compiler libprotobuf-dev
libeigen3-dev libompl-dev libfcl-dev libccd-dev libassimp-dev libbullet-dev liburdfdom-dev liburdfdom-headers-dev
libtinyxml2-dev libqhull-dev libglpk-dev libboost-dev libboost-filesystem-dev libboost-serialization-dev libboost-system-dev
nlohmann-json3-dev libcli11-dev
pybind11-dev python3-dev python3-numpy
libgtest-dev libgmock-dev libbenchmark-dev mold
"
test_packages="chromium universal-ctags locales"
python_packages="python3"  # with --test, unless there is a Python of at least version 3.9 already
page_packages="nodejs npm"  # unless there is a Node.js of at least version 18 with npm already

if [ "${1:-}" = --test ]; then
  packages="$packages $test_packages"
  python3 -c 'import sys; sys.exit(sys.version_info < (3, 9))' 2>/dev/null || packages="$packages $python_packages"
fi
node_version=$(node --version 2>/dev/null | sed 's/^v\([0-9]*\).*/\1/')
if ! command -v npm >/dev/null 2>&1 || [ "${node_version:-0}" -lt 18 ]; then packages="$packages $page_packages"; fi

missing=""
for package in $packages; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) || status=""
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" -ne 0 ]; then
  echo "setup: these packages are missing and only root can install them; run: sudo apt-get install$missing" >&2
  exit 3
fi
echo "setup: installing$missing" >&2
export DEBIAN_FRONTEND=noninteractive
# shellcheck disable=SC2086 # the list is meant to be split
apt-get install -y --no-install-recommends $missing >&2 || {
  apt-get update >&2
  apt-get install -y --no-install-recommends $missing >&2
}
