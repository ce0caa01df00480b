# SPDX-License-Identifier: Apache-2.0
handsel_test(offer_detection GROUP manipulation_planner
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/offer_detection_test.cpp
    ${CMAKE_CURRENT_SOURCE_DIR}/support/acts/acted_person.cpp
    ${CMAKE_CURRENT_SOURCE_DIR}/support/acts/recorded_sequence.cpp
    ${CMAKE_CURRENT_SOURCE_DIR}/support/acts/scripted_sequence.cpp
    ${CMAKE_CURRENT_SOURCE_DIR}/support/acts/simulated_sequence.cpp
  LINK handsel_manipulation_planner_core handsel_spark handsel_sim_core
  LABEL property)
