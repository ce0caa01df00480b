# SPDX-License-Identifier: Apache-2.0
handsel_test(trajectory_planner GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_planner_test.cpp LINK handsel_trajectory_planner LABEL unit)
handsel_test(cartesian_motion GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory/cartesian_motion_test.cpp ${CMAKE_CURRENT_LIST_DIR}/../property/cartesian_motion_test.cpp LINK handsel_trajectory_planner_core
             LABEL property)
handsel_test(broken_lines GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/broken_lines_test.cpp LINK handsel_trajectory_planner_core
             LABEL property)
handsel_test(trajectory_size GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory/trajectory_size_test.cpp LINK handsel_trajectory_planner_core handsel_bus LABEL unit)
