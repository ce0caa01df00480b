#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# outside_test.sh <kind> <source> <build> <cmake>: configures, builds and runs examples/cpp outside the tree.
#   installed  against components installed from the build; also pkg-config, link list and mistakes of find_package
#   models     the same for model, collision and cost, which need packages of others
#   shared     against shared libraries built without the rest of the system; also what they export
#   fetched    with the source tree as a part of the project (FetchContent)
set -eu
kind=$1 source=$2 build=$3 cmake=$4
work=$(mktemp -d "${TMPDIR:-/tmp}/handsel-libraries.XXXXXX")
trap 'rm -rf "$work"' EXIT
fail() { echo "outside_test: $1" >&2; exit 1; }
run() { "$@" >"$work/log" 2>&1 || { cat "$work/log"; fail "failed: $*"; }; }

# examples <option>...: builds and runs the examples of trajectory, grasp and record.
examples() {
  cp -r "$source/examples/cpp" "$work/cpp"
  run "$cmake" -S "$work/cpp" -B "$work/cpp/build" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@"
  run "$cmake" --build "$work/cpp/build" --parallel 2
  (cd "$work/cpp/build" && run ctest --output-on-failure && cat "$work/log")
}

# links_only <file>: the file needs no shared library beyond the C++ runtime.
links_only() {
  objdump -p "$1" >"$work/headers" || fail "objdump cannot read $1"
  sed -n 's/^ *NEEDED *//p' "$work/headers" >"$work/needed"
  grep -q '^libstdc++\.so' "$work/needed" || fail "objdump lists no libstdc++ for $1: the list is not complete"
  others=$(awk '!/^(libstdc\+\+|libm|libgcc_s|libc|ld-linux.*)\.so/' "$work/needed")
  [ -z "$others" ] || fail "$1 needs also: $others"
}

# exports_only_own <file>: the shared library exports names of the project and no others.
exports_only_own() {
  nm -DC --defined-only "$1" >"$work/symbols" || fail "nm cannot read $1"
  grep -q handsel "$work/symbols" || fail "$1 exports nothing"
  foreign=$(cut -d' ' -f3- "$work/symbols" | awk '!/handsel/')
  [ -z "$foreign" ] || fail "$1 exports names of others: $foreign"
}

# refused <pattern> <component>...: find_package refuses the components with a sentence that matches.
refused() {
  pattern=$1
  shift
  mkdir -p "$work/refused"
  printf 'cmake_minimum_required(VERSION 3.25)\nproject(refused LANGUAGES CXX)\nfind_package(handsel REQUIRED COMPONENTS %s)\n' \
    "$*" >"$work/refused/CMakeLists.txt"
  if "$cmake" -S "$work/refused" -B "$work/refused/build" -DCMAKE_PREFIX_PATH="$work/prefix" >"$work/log" 2>&1; then
    fail "find_package accepted: $*"
  fi
  tr -s '\n ' ' ' <"$work/log" | grep -q "$pattern" || { cat "$work/log"; fail "no sentence with: $pattern"; }
}

case $kind in
  installed)
    for component in trajectory grasp record; do
      run "$cmake" --install "$build" --component $component --prefix "$work/prefix"
    done
    for unwanted in bin share; do
      [ ! -e "$work/prefix/$unwanted" ] || fail "the components install $unwanted/ as well"
    done
    if grep -rn '"common/' "$work/prefix/include"; then fail "an installed header includes from the source tree"; fi
    examples -DCMAKE_PREFIX_PATH="$work/prefix"
    links_only "$work/cpp/build/01_two_states"
    links_only "$work/cpp/build/08_grasp"
    links_only "$work/cpp/build/09_recording"
    refused "there is no component teleport" teleport
    refused "handsel-model, which is not installed" model
    refused "component idl is not installed" idl
    # The same without CMake. The package may be moved: the files of pkg-config find their place.
    mv "$work/prefix" "$work/moved"
    export PKG_CONFIG_PATH="$work/moved/lib/pkgconfig"
    # shellcheck disable=SC2046 # the flags are meant to be split
    run c++ -std=c++20 "$source/examples/cpp/04_stop.cpp" -o "$work/stop" $(pkg-config --cflags --libs handsel-trajectory)
    run "$work/stop"
    [ "$(pkg-config --modversion handsel-trajectory)" = "$(sed -n 's/^project(handsel VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")" ] ||
      fail "the version of pkg-config is not that of the project"
    ;;
  models)
    for component in trajectory model collision; do
      run "$cmake" --install "$build" --component $component --prefix "$work/prefix"
    done
    refused "handsel-cost, which is not installed" cost
    run "$cmake" --install "$build" --component cost --prefix "$work/prefix"
    examples -DCMAKE_PREFIX_PATH="$work/prefix" "-DHANDSEL_EXAMPLES=model;collision;cost" \
      -DHANDSEL_ROBOT="$source/deploy/robots/jido/jido.txtpb"
    grep -q '100% tests passed, 0 tests failed out of 3' "$work/log" || fail "not all three examples ran"
    # The list of pkg-config is complete as well.
    export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig"
    # shellcheck disable=SC2046 # the flags are meant to be split
    run c++ "$work/cpp/build/CMakeFiles/12_costs.dir/12_costs.cpp.o" -o "$work/costs" $(pkg-config --libs handsel-cost)
    run "$work/costs" "$source/deploy/robots/jido/jido.txtpb"
    ;;
  shared)
    run "$cmake" -S "$source" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DHANDSEL_LIBRARIES_ONLY=ON -DHANDSEL_SHARED=ON
    run "$cmake" --build "$work/build" --parallel 2
    run "$cmake" --install "$work/build" --prefix "$work/prefix"
    examples -DCMAKE_PREFIX_PATH="$work/prefix"
    for library in trajectory grasp record; do
      file=$work/prefix/lib/libhandsel_$library.so
      links_only "$file"
      exports_only_own "$file"
    done
    ;;
  fetched) examples -DHANDSEL_SOURCE="$source" ;;
  *) fail "unknown kind $kind" ;;
esac
echo "outside_test: $kind: ok"
