# SPDX-License-Identifier: Apache-2.0
add_executable(bench_live ${CMAKE_CURRENT_LIST_DIR}/live_bench.cpp)
target_link_libraries(bench_live PRIVATE handsel_path_planner_core)
target_compile_definitions(bench_live PRIVATE HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
