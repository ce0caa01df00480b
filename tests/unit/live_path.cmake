# SPDX-License-Identifier: Apache-2.0
handsel_test(live_path GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/live_path_test.cpp LINK handsel_path_planner_core LABEL unit)
