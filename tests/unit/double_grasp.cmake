# SPDX-License-Identifier: Apache-2.0
handsel_test(double_grasp GROUP grasp_planner SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasp_planner/double_grasp_test.cpp LINK handsel_grasp_planner_core LABEL unit)
