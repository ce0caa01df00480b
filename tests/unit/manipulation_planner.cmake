handsel_test(manipulation_planner SOURCES ${CMAKE_CURRENT_LIST_DIR}/manipulation_planner_test.cpp ${CMAKE_CURRENT_LIST_DIR}/way_out_test.cpp LINK handsel_manipulation_planner_core LABEL unit)
