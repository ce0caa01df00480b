# SPDX-License-Identifier: Apache-2.0
set(manipulation_planner_tests ${CMAKE_CURRENT_LIST_DIR}/manipulation_planner)
handsel_test(manipulation_planner GROUP manipulation_planner
  SOURCES
    ${manipulation_planner_tests}/manipulation_planner_test.cpp
    ${manipulation_planner_tests}/offer_detector_test.cpp
    ${manipulation_planner_tests}/online_replanner_test.cpp
    ${manipulation_planner_tests}/otp_search_test.cpp
    ${manipulation_planner_tests}/target_shift_test.cpp
    ${manipulation_planner_tests}/offer_area_test.cpp
    ${manipulation_planner_tests}/receiver_hands_test.cpp
    ${manipulation_planner_tests}/place_search_test.cpp
    ${manipulation_planner_tests}/receive_test.cpp
    ${manipulation_planner_tests}/retreat_planner_test.cpp
    ${manipulation_planner_tests}/drive_test.cpp
    ${manipulation_planner_tests}/standing_search_test.cpp
    ${manipulation_planner_tests}/two_hand_otp_test.cpp
    ${manipulation_planner_tests}/object_sight_test.cpp
  LINK handsel_manipulation_planner_core
  LABEL unit)
