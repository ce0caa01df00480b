#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# branch_coverage.sh <test> <object> <source>: runs the test, then fails unless every line and every branch of the source was taken.
# To be run in the folder the source was compiled in; the object is compiled with --coverage, -O0 and -fno-exceptions, so that only written
# branches count.
set -eu
test=$1 object=$2 name=$(basename "$3")
rm -f "${object%.o}.gcda"
"$test" >/dev/null || { echo "$test failed"; exit 1; }
command -v gcov >/dev/null || { echo "gcov is missing; run: sudo apt-get install gcc"; exit 1; }
gcov --stdout --branch-probabilities --branch-counts "$object" 2>/dev/null | awk -v name="$name" '
  /^ *-: *0:Source:/ { n = split($0, part, "/"); here = part[n] == name }
  !here { next }
  /^ *[0-9]+\*?: *[0-9]+:/ { line = $0; ++lines }
  /^ *#####: *[0-9]+:/ { line = $0; ++lines; print "line not run:      " $0; ++missed }
  /^branch/ { ++branches; if (/taken [1-9]/) ++taken; else { print "branch not taken: " line; ++missed } }
  END {
    printf "%s: %d of %d branches taken, %d lines of code\n", name, taken, branches, lines
    exit missed > 0 || branches == 0
  }'
