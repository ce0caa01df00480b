# SPDX-License-Identifier: Apache-2.0
add_executable(bench_bus ${CMAKE_CURRENT_LIST_DIR}/bus_bench.cpp)
target_link_libraries(bench_bus PRIVATE handsel_bus)
target_compile_definitions(bench_bus PRIVATE HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
