# SPDX-License-Identifier: Apache-2.0
handsel_test(two_hands GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/two_hands_test.cpp LINK handsel_lockstep handsel_grasp_planner_core LABEL full)
set_tests_properties(two_hands PROPERTIES TIMEOUT 1800 ENVIRONMENT "HANDSEL_GOALS=1 2 3 4 5")
