#!/bin/sh
# tidy.sh [folder...]: clang-tidy with the checks of .clang-tidy over the sources of the folders (common, components, sim and deploy when
# none is named), one file at a time. Needs clang-tidy and a configured build/release. Exit 1 when something was found.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
cd "$root" || exit 2
command -v clang-tidy >/dev/null || { echo "tidy: clang-tidy is not installed; run: sudo apt-get install clang-tidy" >&2; exit 3; }
[ -f build/release/compile_commands.json ] || cmake --preset release >/dev/null || exit 2
[ $# -gt 0 ] || set -- common components sim deploy
found=0
for file in $(find "$@" -name '*.cpp' | sort); do
  grep -q "/$file\"" build/release/compile_commands.json || continue
  nice -n 19 clang-tidy -p build/release --quiet "$file" 2>/dev/null || found=1
done
exit $found
