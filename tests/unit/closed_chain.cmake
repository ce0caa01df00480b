# SPDX-License-Identifier: Apache-2.0
handsel_test(closed_chain GROUP grasp_planner SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasp_planner/closed_chain_test.cpp LINK handsel_trajectory_planner_core handsel_grasp_planner_core LABEL unit)
