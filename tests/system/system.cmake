# Stories and command-line tests over real processes: one at a time, each on a DDS domain of its own.
set(story_domain 40)
foreach(kind system fault)
  file(GLOB stories CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/../${kind}/*.story)
  foreach(story ${stories})
    get_filename_component(name ${story} NAME_WE)
    math(EXPR story_domain "${story_domain} + 1")
    add_test(NAME ${kind}_${name} COMMAND handsel story --domain ${story_domain} ${story})
    # Of those a user reads first, these run every time: one for each kind of task.
    set(label ${kind})
    if(kind STREQUAL system AND NOT name MATCHES "^(give_mug|back_and_forth|lift|duo_left|duo_other_hand|duo_passes_on|duo_tray|fetch_mug)$")
      set(label full)
    endif()
    set_tests_properties(${kind}_${name} PROPERTIES LABELS ${label} RUN_SERIAL TRUE TIMEOUT 400)
  endforeach()
endforeach()

add_executable(test_command ${CMAKE_CURRENT_LIST_DIR}/command_test.cpp)
target_link_libraries(test_command PRIVATE handsel_options nlohmann_json::nlohmann_json GTest::gtest_main GTest::gmock)
target_compile_definitions(test_command PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>" HANDSEL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
add_dependencies(test_command product)
add_test(NAME command COMMAND test_command)
set_tests_properties(command PROPERTIES LABELS system RUN_SERIAL TRUE TIMEOUT 300)

handsel_test(lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/lockstep_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(lockstep PROPERTIES TIMEOUT 120)

# Over DDS one system at a time; in lock-step nothing depends on real time.
handsel_test(handover SOURCES ${CMAKE_CURRENT_LIST_DIR}/handover_test.cpp LINK handsel_lockstep LABEL system)
target_compile_definitions(test_handover PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_handover product)
set_tests_properties(handover PROPERTIES RUN_SERIAL TRUE TIMEOUT 600 ENVIRONMENT "GTEST_FILTER=Handover.*;HANDSEL_SEEDS=4")
add_test(NAME handover_ten COMMAND test_handover)
set_tests_properties(handover_ten PROPERTIES LABELS full RUN_SERIAL TRUE TIMEOUT 600 ENVIRONMENT GTEST_FILTER=Handover.seeds*)
add_test(NAME handover_lockstep COMMAND test_handover)
set_tests_properties(handover_lockstep PROPERTIES LABELS system PROCESSORS 2 TIMEOUT 300 ENVIRONMENT GTEST_FILTER=Mutants.*:Recorded.*)

handsel_test(rough_sensors SOURCES ${CMAKE_CURRENT_LIST_DIR}/rough_sensors_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(rough_sensors PROPERTIES TIMEOUT 300 ENVIRONMENT GTEST_FILTER=RoughSensors.*)
add_test(NAME rough_sensors_ten COMMAND test_rough_sensors)
set_tests_properties(rough_sensors_ten PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT GTEST_FILTER=RoughSensorsTen.*)

handsel_test(facts_truth SOURCES ${CMAKE_CURRENT_LIST_DIR}/facts_truth_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(facts_truth PROPERTIES TIMEOUT 300)
add_test(NAME facts_truth_twenty COMMAND test_facts_truth)
set_tests_properties(facts_truth_twenty PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT HANDSEL_RUNS=20)

handsel_test(clear_table SOURCES ${CMAKE_CURRENT_LIST_DIR}/clear_table_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(clear_table PROPERTIES TIMEOUT 600)

handsel_test(recoil SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/recoil_test.cpp LINK handsel_lockstep LABEL system)
handsel_test(gentler SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/gentler_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(recoil PROPERTIES TIMEOUT 300)
handsel_test(place_reached SOURCES ${CMAKE_CURRENT_LIST_DIR}/place_reached_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(place_reached PROPERTIES TIMEOUT 1800)

# Latches over the death of processes: a few every time, HANDSEL_RUNS=5 for all.
handsel_test(latches SOURCES ${CMAKE_CURRENT_LIST_DIR}/latches_test.cpp LINK handsel_command LABEL fault)
target_compile_definitions(test_latches PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_latches product)
set_tests_properties(latches PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)

# Sources of people that fall silent, freeze, repeat nobody, are late or look elsewhere: each once every time, eight times for all.
handsel_test(blind SOURCES ${CMAKE_CURRENT_LIST_DIR}/blind_test.cpp LINK handsel_command LABEL fault)
add_dependencies(test_blind product)
set_tests_properties(blind PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
add_test(NAME blind_forty COMMAND test_blind)
set_tests_properties(blind_forty PROPERTIES LABELS full RUN_SERIAL TRUE TIMEOUT 1800 ENVIRONMENT HANDSEL_RUNS=8)

# Long: trials of people who differ over real processes, and deaths at random.
handsel_test(exchanges SOURCES ${CMAKE_CURRENT_LIST_DIR}/exchanges_test.cpp LINK handsel_command LABEL full)
add_dependencies(test_exchanges product)
set_tests_properties(exchanges PROPERTIES RUN_SERIAL TRUE TIMEOUT 14400)

handsel_test(supervised_life SOURCES ${CMAKE_CURRENT_LIST_DIR}/supervised_life_test.cpp LINK handsel_command LABEL system)
target_compile_definitions(test_supervised_life PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_supervised_life product)
set_tests_properties(supervised_life PROPERTIES RUN_SERIAL TRUE TIMEOUT 240)

handsel_test(eval SOURCES ${CMAKE_CURRENT_LIST_DIR}/eval_test.cpp LINK nlohmann_json::nlohmann_json GTest::gmock LABEL system)
target_compile_definitions(test_eval PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_eval handsel)
set_tests_properties(eval PROPERTIES TIMEOUT 180)

handsel_test(between_hands SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/between_hands_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(test_between_hands PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_between_hands handsel)
set_tests_properties(between_hands PROPERTIES PROCESSORS 2 TIMEOUT 300)
handsel_test(robot_drives SOURCES ${CMAKE_CURRENT_LIST_DIR}/driving/robot_drives_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(test_robot_drives PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_robot_drives handsel)
set_tests_properties(robot_drives PROPERTIES TIMEOUT 300)
handsel_test(carried_upright SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/carried_upright_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(test_carried_upright PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_carried_upright handsel)
set_tests_properties(carried_upright PROPERTIES PROCESSORS 2 TIMEOUT 300)
