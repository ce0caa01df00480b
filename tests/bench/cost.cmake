# SPDX-License-Identifier: Apache-2.0
add_executable(bench_cost ${CMAKE_CURRENT_LIST_DIR}/cost_bench.cpp)
target_link_libraries(bench_cost PRIVATE handsel_costmap_core nlohmann_json::nlohmann_json)
target_compile_definitions(bench_cost PRIVATE HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
