# SPDX-License-Identifier: Apache-2.0
handsel_test(trajectory_switch SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory/switch_test.cpp ${CMAKE_CURRENT_LIST_DIR}/../support/allocation_counter.cpp LINK handsel_trajectory LABEL unit)
handsel_test(motion_stories SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/motion_stories_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../support/lane_level.cpp LINK handsel_trajectory LABEL property)
handsel_test_again(motion_stories_long OF motion_stories)
set_tests_properties(motion_stories_long PROPERTIES LABELS full ENVIRONMENT "HANDSEL_RUNS=200000;HANDSEL_SEED=100001" TIMEOUT 3600)
