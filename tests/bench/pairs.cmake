# SPDX-License-Identifier: Apache-2.0
add_executable(bench_pairs ${CMAKE_CURRENT_LIST_DIR}/pairs_bench.cpp)
target_link_libraries(bench_pairs PRIVATE handsel_grasp_planner_core)
target_compile_definitions(bench_pairs PRIVATE HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
