# SPDX-License-Identifier: Apache-2.0
handsel_test(regrasp GROUP grasp_planner SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/regrasp_test.cpp LINK handsel_grasp_planner_core LABEL unit)
handsel_test_again(regrasp_three OF regrasp)
set_tests_properties(regrasp_three PROPERTIES LABELS full TIMEOUT 300 ENVIRONMENT "HANDSEL_OBJECTS=all")
