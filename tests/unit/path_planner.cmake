# SPDX-License-Identifier: Apache-2.0
handsel_test(path_planner GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/path_planner_test.cpp LINK handsel_path_planner_core LABEL unit)
target_include_directories(tests_planning SYSTEM PRIVATE ${OMPL_INCLUDE_DIRS})
handsel_test(path_planner_property GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/path_planner_property_test.cpp LINK handsel_path_planner_core
             LABEL unit)
handsel_test(planning_nodes GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/planning_nodes_test.cpp LINK handsel_path_planner handsel_collision_checker
             handsel_costmap LABEL unit)
handsel_test(path_cost GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/path_cost_test.cpp LINK handsel_path_planner_core handsel_costmap_core
             LABEL unit)
handsel_test_again(path_cost_two_hundred OF path_cost)
set_tests_properties(path_cost_two_hundred PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT HANDSEL_RUNS=200)
handsel_test(panda_paths GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/panda_paths_test.cpp LINK handsel_path_planner_core
             nlohmann_json::nlohmann_json LABEL unit)
handsel_test_again(panda_paths_all OF panda_paths)
set_tests_properties(panda_paths_all PROPERTIES LABELS full TIMEOUT 1800 ENVIRONMENT HANDSEL_RUNS=0)
handsel_test(upright_paths GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/upright_paths_test.cpp LINK handsel_path_planner_core LABEL unit)
handsel_test_again(upright_paths_hundred OF upright_paths)
set_tests_properties(upright_paths_hundred PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT HANDSEL_RUNS=100)
handsel_test(pose_goals GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/pose_goals_test.cpp LINK handsel_path_planner_core LABEL unit)
handsel_test(driving GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/driving_test.cpp LINK handsel_path_planner LABEL unit)
handsel_test(path_request GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/path_request_test.cpp LINK handsel_path_planner LABEL unit)
handsel_test(landscape GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/landscape_test.cpp LINK handsel_landscape LABEL unit)
