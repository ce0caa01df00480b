# SPDX-License-Identifier: Apache-2.0
set(every_node)
foreach(box sim spark costmap collision_checker path_planner grasp_planner trajectory_planner manipulation_planner attention
            trajectory_controller supervisor)
  if(NOT TARGET handsel_${box})
    message(STATUS "no table test: handsel_${box} is not there")
    return()
  endif()
  list(APPEND every_node handsel_${box})
endforeach()
handsel_test(table SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/table_test.cpp LINK ${every_node} LABEL unit)
