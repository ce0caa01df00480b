# SPDX-License-Identifier: Apache-2.0
if(TARGET handsel_sim_core AND TARGET handsel_trajectory_controller_core)
  handsel_test(grasp_holds GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/grasp_holds_test.cpp
    LINK handsel_grasp_planner handsel_grasp_planner_core handsel_trajectory_controller_core handsel_sim_core LABEL system)
  set_tests_properties(grasp_holds PROPERTIES TIMEOUT 300 ENVIRONMENT "GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=0")
  handsel_test_again(grasp_holds_more OF grasp_holds)
  set_tests_properties(grasp_holds_more PROPERTIES LABELS system TIMEOUT 300 ENVIRONMENT "GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=1")
  handsel_test(grasp_quality GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/grasp_quality_test.cpp
    LINK handsel_grasp_planner_core handsel_trajectory_controller_core handsel_sim_core LABEL full)
  set_tests_properties(grasp_quality PROPERTIES TIMEOUT 7200)
endif()
handsel_test(grasp_table GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/grasp_table_test.cpp LINK handsel_grasp_picture LABEL full)
set_tests_properties(grasp_table PROPERTIES TIMEOUT 1800)
