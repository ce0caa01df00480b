# SPDX-License-Identifier: Apache-2.0
handsel_test(guard GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/guard_test.cpp LINK handsel_trajectory_controller_core LABEL unit)
handsel_test(controller GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_queue_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_whole_robot_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_speed_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_contact_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_silence_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/gaze_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/contact_watch_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/hand_executor_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_overload_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_blind_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/observed_space_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/path_runner_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/mode_machine_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/speed_rise_test.cpp LINK handsel_trajectory_controller_core handsel_robot_side LABEL unit)
# Each part of the controller alone.
handsel_test(controller_parts GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_inputs_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/controller_arm_test.cpp LINK handsel_trajectory_controller_core LABEL unit)
handsel_test(finger_limit GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/finger_limit_test.cpp LINK handsel_trajectory_controller_core LABEL unit)
handsel_test(both_hands GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/both_hands_test.cpp LINK handsel_trajectory_controller_core LABEL unit)
handsel_test(go_gate GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/go_gate_test.cpp LINK handsel_trajectory_controller_core LABEL unit)
# Latches over supervisor and controller.
handsel_test(latches_property GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/latches_property_test.cpp
             LINK handsel_supervisor_core handsel_trajectory_controller_core LABEL property)
handsel_test(controller_stories SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/controller_stories_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../support/allocation_counter.cpp LINK handsel_trajectory_controller_core LABEL property)
handsel_test(separation_stories GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/separation_stories_test.cpp LINK handsel_trajectory_controller_core LABEL property)
handsel_test(stop_proof GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/stop_proof_test.cpp LINK handsel_trajectory_controller_core LABEL property)
handsel_test_again(stop_proof_million OF stop_proof)
set_tests_properties(stop_proof_million PROPERTIES LABELS full TIMEOUT 3600 ENVIRONMENT HANDSEL_PROOF_MOTIONS=1000000)
set_tests_properties(controller_stories separation_stories PROPERTIES TIMEOUT 300)
handsel_test_again(controller_stories_millions OF controller_stories FILTER "ControllerStories.every_set_point*")
set_tests_properties(controller_stories_millions PROPERTIES LABELS full TIMEOUT 900
  ENVIRONMENT HANDSEL_STORY_STEPS=4000000)
handsel_test_again(separation_stories_thousand OF separation_stories)
set_tests_properties(separation_stories_thousand PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT HANDSEL_SEPARATION_RUNS=1000)
handsel_test(realtime GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/../system/realtime_test.cpp LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_CONTROLLER="$<TARGET_FILE:handsel_trajectory_controller_process>")
add_dependencies(tests_live handsel_trajectory_controller_process)
set_tests_properties(realtime PROPERTIES RUN_SERIAL TRUE TIMEOUT 60)
# Every branch of the guard is taken by its test: the same sources, compiled for counting.
set(guard_source ${CMAKE_SOURCE_DIR}/components/trajectory_controller/supervise/guard.cpp)
set_source_files_properties(${guard_source} PROPERTIES COMPILE_OPTIONS "--coverage;-O0;-fno-exceptions;-fno-inline")
add_executable(guard_coverage ${CMAKE_CURRENT_LIST_DIR}/trajectory_controller/guard_test.cpp ${guard_source})
target_link_libraries(guard_coverage PRIVATE handsel_trajectory_controller_core GTest::gtest_main)
target_link_options(guard_coverage PRIVATE --coverage)
add_test(NAME guard_branches COMMAND ${CMAKE_SOURCE_DIR}/cmake/branch_coverage.sh $<TARGET_FILE:guard_coverage>
  "$<FILTER:$<TARGET_OBJECTS:guard_coverage>,INCLUDE,guard\\.cpp>" ${guard_source} WORKING_DIRECTORY ${CMAKE_BINARY_DIR})
set_tests_properties(guard_branches PROPERTIES LABELS unit)
