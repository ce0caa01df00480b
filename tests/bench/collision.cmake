# SPDX-License-Identifier: Apache-2.0
add_executable(bench_collision ${CMAKE_CURRENT_LIST_DIR}/collision_bench.cpp)
target_link_libraries(bench_collision PRIVATE handsel_collision nlohmann_json::nlohmann_json)
