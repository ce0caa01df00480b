# SPDX-License-Identifier: Apache-2.0
# The peer of the trajectory library, built from its sources wherever they are: -DHANDSEL_RUCKIG=<path>. The project does without.
set(HANDSEL_RUCKIG "" CACHE PATH "Sources of Ruckig, for benchmarks and tests beside it")
if(HANDSEL_RUCKIG)
  file(GLOB ruckig_sources ${HANDSEL_RUCKIG}/src/ruckig/*_step?.cpp ${HANDSEL_RUCKIG}/src/ruckig/brake.cpp)
  add_library(ruckig_peer STATIC ${ruckig_sources} ${CMAKE_CURRENT_LIST_DIR}/support/oracles/ruckig_peer.cpp)
  target_include_directories(ruckig_peer SYSTEM PRIVATE ${HANDSEL_RUCKIG}/include)
  target_include_directories(ruckig_peer PRIVATE ${CMAKE_SOURCE_DIR})
  target_compile_options(ruckig_peer PRIVATE -O3 -march=native)
  target_compile_definitions(ruckig_peer INTERFACE HANDSEL_RUCKIG)
endif()
