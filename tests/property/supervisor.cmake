# SPDX-License-Identifier: Apache-2.0
handsel_test(task_planner_property GROUP supervisor SOURCES ${CMAKE_CURRENT_LIST_DIR}/task_planner_property_test.cpp LINK handsel_supervisor_core LABEL unit)
