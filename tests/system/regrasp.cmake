handsel_test(regrasp SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/regrasp_test.cpp LINK handsel_grasp_planner_core LABEL unit)
add_test(NAME regrasp_three COMMAND test_regrasp)
set_tests_properties(regrasp_three PROPERTIES LABELS full TIMEOUT 300 ENVIRONMENT "HANDSEL_OBJECTS=all")
