handsel_test(trajectory_planner SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_planner_test.cpp LINK handsel_trajectory_planner LABEL unit)
