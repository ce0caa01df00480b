# SPDX-License-Identifier: Apache-2.0
add_executable(bench_attention ${CMAKE_CURRENT_LIST_DIR}/attention_bench.cpp)
target_link_libraries(bench_attention PRIVATE handsel_attention handsel_bus nlohmann_json::nlohmann_json)
target_compile_definitions(bench_attention PRIVATE HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
