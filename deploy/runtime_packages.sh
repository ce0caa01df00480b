#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# runtime_packages.sh <folder>...: the Debian packages that hold the shared libraries which the programs in the folders name, one a line.
set -eu
for folder in "$@"; do
  for program in "$folder"/*; do
    objdump -p "$program" 2>/dev/null | sed -n 's/^ *NEEDED *//p'
  done
done | sort -u | while read -r library; do
  file=$(ldconfig -p | awk -v name="$library" '$1 == name { print $NF; exit }')
  [ -n "$file" ] || continue
  # /lib may be a link to /usr/lib, and the package may know either name.
  for name in "$file" "$(readlink -f "$file")" "/usr$file" "${file#/usr}"; do
    dpkg-query -S "$name" 2>/dev/null && break
  done
done | sed 's/:.*//' | sort -u
