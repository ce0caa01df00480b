# SPDX-License-Identifier: Apache-2.0
handsel_test(sim GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/sim_test.cpp ${CMAKE_CURRENT_LIST_DIR}/sim/time_keeper_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(scene_setup GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/scene_setup_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(sim_oracle GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/sim_oracle_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(sim_person GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/sim_person_test.cpp ${CMAKE_CURRENT_LIST_DIR}/sim/person_giver_test.cpp ${CMAKE_CURRENT_LIST_DIR}/sim/recorded_person_test.cpp ${CMAKE_CURRENT_LIST_DIR}/sim/step_in_test.cpp ${CMAKE_CURRENT_LIST_DIR}/sim/person_guided_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/sim/free_grasp_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/sim/two_hand_person_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(sensors GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/sensors_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(recording GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/recording_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(robot_side GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/robot_side_test.cpp LINK handsel_drivers LABEL property)
handsel_test(platform_odometry GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/platform_odometry_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(moving_offer GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/moving_offer_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(sim_node GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/sim_node_test.cpp LINK handsel_sim LABEL unit)
