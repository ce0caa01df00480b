add_executable(bench_planner ${CMAKE_CURRENT_LIST_DIR}/planner_bench.cpp)
target_link_libraries(bench_planner PRIVATE handsel_path_planner_core handsel_costmap_core)
target_compile_definitions(bench_planner PRIVATE HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
