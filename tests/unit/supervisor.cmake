# SPDX-License-Identifier: Apache-2.0
handsel_test(supervisor GROUP supervisor SOURCES ${CMAKE_CURRENT_LIST_DIR}/supervisor/supervisor_test.cpp LINK handsel_supervisor_core LABEL unit)
handsel_test(task_planner GROUP supervisor SOURCES ${CMAKE_CURRENT_LIST_DIR}/supervisor/task_planner_test.cpp LINK handsel_supervisor_core LABEL unit)
handsel_test(safety_latches GROUP supervisor SOURCES ${CMAKE_CURRENT_LIST_DIR}/supervisor/safety_latches_test.cpp LINK handsel_supervisor LABEL unit)
