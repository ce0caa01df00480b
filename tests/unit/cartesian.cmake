handsel_test(cartesian SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/cartesian_test.cpp LINK handsel_path_planner_core LABEL unit)
add_test(NAME cartesian_100 COMMAND test_cartesian)
set_tests_properties(cartesian_100 PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT "HANDSEL_QUERIES=100;GTEST_FILTER=*jumps*")
