handsel_test(trajectory SOURCES ${CMAKE_CURRENT_LIST_DIR}/min_time_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_test.cpp ${CMAKE_CURRENT_LIST_DIR}/time_law_test.cpp ${CMAKE_CURRENT_LIST_DIR}/smooth_test.cpp ${CMAKE_CURRENT_LIST_DIR}/approximate_test.cpp
  LINK handsel_trajectory LABEL unit)
handsel_test(trajectory_property SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/trajectory_property_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../support/allocation_counter.cpp LINK handsel_trajectory LABEL property)
# Ten million problems: some minutes of one core.
add_test(NAME trajectory_ten_million COMMAND test_trajectory_property --gtest_filter=SevenAxes.EndTogether*)
set_tests_properties(trajectory_ten_million PROPERTIES LABELS full TIMEOUT 3600 ENVIRONMENT "HANDSEL_CASES=10000000;HANDSEL_SLOW=100000")
