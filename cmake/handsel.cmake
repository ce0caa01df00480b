# How every library, component and test of the project is made.

add_library(handsel_options INTERFACE)
target_compile_options(handsel_options INTERFACE -Wall -Wextra -Wshadow -Wno-psabi -Werror)
target_include_directories(handsel_options INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
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
if(HANDSEL_MOLD)
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
option(HANDSEL_PRECOMPILED "Parse headers of other projects once: a full build is faster" ON)

set(HANDSEL_HEADERS <algorithm> <array> <chrono> <cmath> <filesystem> <fstream> <functional> <iostream> <map> <memory> <mutex> <optional>
    <random> <set> <sstream> <string> <thread> <unordered_map> <variant> <vector> <Eigen/Dense>)

# handsel_parsed_headers(<target> <header> ...): lets the target, which has no code, parse headers for others.
function(handsel_parsed_headers target)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/${target}.cpp CONTENT "")
  target_sources(${target} PRIVATE ${CMAKE_BINARY_DIR}/generated/${target}.cpp)
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

# handsel_library(<name> SOURCES a.cpp ... LINK lib ...): static library handsel_<name>.
function(handsel_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(handsel_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(handsel_${name} PUBLIC handsel_options Eigen3::Eigen ${ARG_LINK})
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

# handsel_test(<name> SOURCES a_test.cpp ... LINK lib ... [LABEL unit]): a GoogleTest binary test_<name>.
function(handsel_test name)
  cmake_parse_arguments(ARG "" "LABEL" "SOURCES;LINK" ${ARGN})
  add_executable(test_${name} ${ARG_SOURCES})
  target_link_libraries(test_${name} PRIVATE handsel_options ${ARG_LINK} GTest::gtest_main GTest::gmock)
  target_compile_definitions(test_${name} PRIVATE HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  add_test(NAME ${name} COMMAND test_${name})
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABEL}")
  # Such a test starts processes and waits for them: its own speed does not matter.
  if(ARG_LABEL MATCHES "^(system|fault)$")
    target_compile_options(test_${name} PRIVATE -O1)
  endif()
  handsel_precompiled(test_${name} handsel_test_headers)
endfunction()
