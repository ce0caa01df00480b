# SPDX-License-Identifier: Apache-2.0
# How every library, component and test of the project is made.

add_library(handsel_options INTERFACE)
if(NOT HANDSEL_LIBRARIES_ONLY)
  target_compile_options(handsel_options INTERFACE -Wall -Wextra -Wshadow -Wno-psabi -Werror)
endif()
target_include_directories(handsel_options INTERFACE ${handsel_SOURCE_DIR} ${handsel_BINARY_DIR}/generated)
option(HANDSEL_ASAN "Address and undefined-behaviour sanitizers" OFF)
option(HANDSEL_TSAN "Thread sanitizer" OFF)
if(HANDSEL_ASAN)
  target_compile_options(handsel_options INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer)
  target_link_options(handsel_options INTERFACE -fsanitize=address,undefined)
elseif(HANDSEL_TSAN)
  target_compile_options(handsel_options INTERFACE -fsanitize=thread)
  target_link_options(handsel_options INTERFACE -fsanitize=thread)
endif()
find_program(HANDSEL_MOLD mold)
if(HANDSEL_MOLD AND NOT HANDSEL_LIBRARIES_ONLY)
  add_link_options(-fuse-ld=mold)
endif()

# Several sources of a library are compiled as one, since most of the time goes into shared headers.
option(HANDSEL_UNITY "Compile sources in groups: a full build is faster, a change rebuilds more" ON)
set(HANDSEL_UNITY_BATCH 12)

# handsel_unity(<target>): compiles the sources of the target in groups.
function(handsel_unity target)
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${HANDSEL_UNITY} UNITY_BUILD_BATCH_SIZE ${HANDSEL_UNITY_BATCH})
  # In a group the compiler takes a private type of a source file for one of a header.
  target_compile_options(${target} PRIVATE $<$<BOOL:${HANDSEL_UNITY}>:-Wno-subobject-linkage>)
endfunction()

# Headers of the standard library, Eigen and GoogleTest are parsed once, not again for every source.
set(precompiled ON)
if(HANDSEL_LIBRARIES_ONLY)
  set(precompiled OFF)
endif()
option(HANDSEL_PRECOMPILED "Parse headers of other projects once: a full build is faster" ${precompiled})

set(HANDSEL_HEADERS <algorithm> <array> <chrono> <cmath> <filesystem> <fstream> <functional> <iostream> <map> <memory> <mutex> <optional>
    <random> <set> <sstream> <string> <thread> <unordered_map> <variant> <vector> <Eigen/Dense>)

# handsel_parsed_headers(<target> <header> ...): lets the target, which has no code, parse headers for others.
function(handsel_parsed_headers target)
  file(CONFIGURE OUTPUT ${handsel_BINARY_DIR}/generated/${target}.cpp CONTENT "")
  target_sources(${target} PRIVATE ${handsel_BINARY_DIR}/generated/${target}.cpp)
  if(HANDSEL_PRECOMPILED)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# handsel_precompiled(<target> <headers>): compiles the sources of the target with the headers that the target <headers> has
# parsed; not those with compile options of their own, which the parsed headers do not fit.
function(handsel_precompiled target headers)
  if(NOT HANDSEL_PRECOMPILED)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
  # Of a parsed header the compiler forgets that the header is another project's, and warns of GCC 12's own std::string.
  target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    if(options)
      set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()

# handsel_library(<name> SOURCES a.cpp ... LINK lib ...): library handsel_<name>, static unless HANDSEL_SHARED.
function(handsel_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  set(type STATIC)
  if(HANDSEL_SHARED)
    set(type SHARED)
  endif()
  add_library(handsel_${name} ${type} ${ARG_SOURCES})
  target_link_libraries(handsel_${name} PUBLIC $<BUILD_INTERFACE:handsel_options> Eigen3::Eigen ${ARG_LINK})
  handsel_unity(handsel_${name})
  handsel_precompiled(handsel_${name} handsel_headers)
endfunction()

# handsel_component(<name> CORE a.cpp ... NODE node.cpp ... LINK lib ...): core library handsel_<name>_core (no DDS),
# node library handsel_<name> (core bound to a Bus) and the process handsel_<name> from main.cpp.
function(handsel_component name)
  cmake_parse_arguments(ARG "" "" "CORE;NODE;LINK" ${ARGN})
  handsel_library(${name}_core SOURCES ${ARG_CORE} LINK ${ARG_LINK})
  handsel_library(${name} SOURCES ${ARG_NODE} LINK handsel_${name}_core handsel_bus handsel_config)
  add_executable(handsel_${name}_process main.cpp)
  set_target_properties(handsel_${name}_process PROPERTIES OUTPUT_NAME handsel_${name})
  target_link_libraries(handsel_${name}_process PRIVATE handsel_${name})
  install(TARGETS handsel_${name}_process RUNTIME DESTINATION bin)
endfunction()

# handsel_test_binary(<target> <label>): a GoogleTest binary without sources.
function(handsel_test_binary target label)
  add_executable(${target})
  target_link_libraries(${target} PRIVATE handsel_options GTest::gtest_main GTest::gmock)
  target_compile_definitions(${target} PRIVATE HANDSEL_SOURCE_DIR="${handsel_SOURCE_DIR}")
  # Such a test starts processes and waits for them: its own speed does not matter.
  if(label MATCHES "^(system|fault)$")
    target_compile_options(${target} PRIVATE -O1)
  endif()
  handsel_unity(${target})
  handsel_precompiled(${target} handsel_test_headers)
endfunction()

# handsel_test_filter(<variable> <test> <filter>): a GoogleTest filter within the test: all of its suites, all but what a filter "-..."
# names, or another filter as it is.
function(handsel_test_filter variable test filter)
  if(filter STREQUAL "" OR filter MATCHES "^-")
    get_property(suites GLOBAL PROPERTY handsel_suites_of_${test})
    string(PREPEND filter "${suites}")
  endif()
  set(${variable} "${filter}" PARENT_SCOPE)
endfunction()

# handsel_test(<name> SOURCES a_test.cpp ... LINK lib ... LABEL unit [GROUP group] [FILTER filter]): a test of the suites in the sources.
# They are compiled into the binary tests_<group>, together with the group's other tests, since most of the time goes into shared
# headers; without a group into a binary test_<name>, e.g. where the sources replace a function of the whole program.
function(handsel_test name)
  cmake_parse_arguments(ARG "" "LABEL;GROUP;FILTER" "SOURCES;LINK" ${ARGN})
  set(binary test_${name})
  if(ARG_GROUP)
    set(binary tests_${ARG_GROUP})
  endif()
  if(NOT TARGET ${binary})
    handsel_test_binary(${binary} "${ARG_LABEL}")
  endif()
  target_sources(${binary} PRIVATE ${ARG_SOURCES})
  target_link_libraries(${binary} PRIVATE ${ARG_LINK})
  set(suites)
  foreach(source ${ARG_SOURCES})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
    file(STRINGS ${source} tests REGEX "^(TYPED_)?TEST(_F|_P)?\\(")
    foreach(test ${tests})
      string(REGEX REPLACE "^[A-Z_]+\\(([A-Za-z0-9_]+).*" "\\1" suite "${test}")
      list(APPEND suites "${suite}.*" "${suite}/*" "*/${suite}.*")
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES suites)
  list(JOIN suites ":" suites)
  set_property(GLOBAL PROPERTY handsel_suites_of_${name} "${suites}")
  set_property(GLOBAL PROPERTY handsel_binary_of_${name} ${binary})
  handsel_test_again(${name} OF ${name} FILTER "${ARG_FILTER}")
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABEL}")
endfunction()

# handsel_test_again(<name> OF <test> [FILTER filter]): runs the test or a part of it once more, e.g. with more seeds.
function(handsel_test_again name)
  cmake_parse_arguments(ARG "" "OF;FILTER" "" ${ARGN})
  get_property(binary GLOBAL PROPERTY handsel_binary_of_${ARG_OF})
  handsel_test_filter(filter ${ARG_OF} "${ARG_FILTER}")
  add_test(NAME ${name} COMMAND ${binary} "--gtest_filter=${filter}")
  set_tests_properties(${name} PROPERTIES FAIL_REGULAR_EXPRESSION "Running 0 tests")  # the filter names none
endfunction()
