# SPDX-License-Identifier: Apache-2.0
find_package(benchmark QUIET)
find_package(Qhull REQUIRED CONFIG)
if(benchmark_FOUND)
  add_executable(bench_grasp ${CMAKE_CURRENT_LIST_DIR}/grasp_bench.cpp)
  target_compile_definitions(bench_grasp PRIVATE HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  target_link_libraries(bench_grasp PRIVATE handsel_grasp_planner_core Qhull::qhull_r benchmark::benchmark_main)
endif()
