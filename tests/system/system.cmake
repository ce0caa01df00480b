# SPDX-License-Identifier: Apache-2.0
# Stories and command-line tests over real processes, each on a DDS domain of its own. Several run at a time: simulated time halts while
# a process waits for a processor.
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
    set_tests_properties(${kind}_${name} PROPERTIES LABELS ${label} TIMEOUT 400)
    # Grasp lists of two hands take a minute or more; deadlines of a story are for a robot that knows its objects.
    if(name MATCHES "^duo|tray$")
      set_tests_properties(${kind}_${name} PROPERTIES FIXTURES_REQUIRED duo_grasps)
    endif()
    # How soon a process is back, or seen to be missing, depends on the machine's time.
    if(kind STREQUAL fault)
      set_tests_properties(${kind}_${name} PROPERTIES RUN_SERIAL TRUE)
    endif()
  endforeach()
endforeach()

add_test(NAME duo_grasps COMMAND handsel grasp prepare duo_tray duo_left)
set_tests_properties(duo_grasps PROPERTIES LABELS unit TIMEOUT 400 FIXTURES_SETUP duo_grasps)
handsel_test(grasp_prepare GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/grasp_prepare_test.cpp LABEL unit)

handsel_test(command GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/command_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
set_tests_properties(command PROPERTIES TIMEOUT 300)

handsel_test(lockstep GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/lockstep_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(lockstep PROPERTIES TIMEOUT 120)

handsel_test(handover GROUP lockstep FILTER "Handover.*" SOURCES ${CMAKE_CURRENT_LIST_DIR}/handover_test.cpp LINK handsel_lockstep LABEL system)
target_compile_definitions(tests_lockstep PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_lockstep product)
set_tests_properties(handover PROPERTIES TIMEOUT 600 ENVIRONMENT "HANDSEL_SEEDS=4")
handsel_test_again(handover_ten OF handover FILTER "Handover.seeds*")
set_tests_properties(handover_ten PROPERTIES LABELS full RUN_SERIAL TRUE TIMEOUT 600)
handsel_test_again(handover_lockstep OF handover FILTER "Mutants.*:Recorded.*")
set_tests_properties(handover_lockstep PROPERTIES LABELS system PROCESSORS 2 TIMEOUT 300)

handsel_test(rough_sensors GROUP lockstep FILTER "RoughSensors.*" SOURCES ${CMAKE_CURRENT_LIST_DIR}/rough_sensors_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(rough_sensors PROPERTIES TIMEOUT 300)
handsel_test_again(rough_sensors_ten OF rough_sensors FILTER "RoughSensorsTen.*")
set_tests_properties(rough_sensors_ten PROPERTIES LABELS full TIMEOUT 900)

handsel_test(facts_truth GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/facts_truth_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(facts_truth PROPERTIES TIMEOUT 300)
handsel_test_again(facts_truth_twenty OF facts_truth)
set_tests_properties(facts_truth_twenty PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT HANDSEL_RUNS=20)

handsel_test(clear_table GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/clear_table_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(clear_table PROPERTIES TIMEOUT 600)

handsel_test(recoil GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/recoil_test.cpp LINK handsel_lockstep LABEL system)
handsel_test(whole_robot GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/motion/whole_robot_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(whole_robot PROPERTIES TIMEOUT 300)
handsel_test(tool_motions GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/motion/tool_motions_test.cpp LINK handsel_lockstep LABEL system)
handsel_test_again(whole_robot_fifty OF whole_robot)
set_tests_properties(whole_robot_fifty PROPERTIES LABELS full TIMEOUT 1800 ENVIRONMENT HANDSEL_WHOLE_MOTIONS=50)
handsel_test(cost_gain GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/cost_gain_test.cpp LINK handsel_lockstep LABEL system)
handsel_test(directed_sensors GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/directed_sensors_test.cpp LINK handsel_lockstep LABEL system)
handsel_test(moved_object GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/moved_object_test.cpp LINK handsel_lockstep LABEL system)
handsel_test(margin_law GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/margin_law_test.cpp LINK handsel_lockstep LABEL system)
handsel_test(exchange_shift GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/exchange_shift_test.cpp LINK handsel_lockstep LABEL system)
handsel_test(gentler GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/people/gentler_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(recoil PROPERTIES TIMEOUT 300)

handsel_test(several_robots GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/robots/several_robots_test.cpp LINK handsel_lockstep LABEL system)
target_compile_definitions(tests_lockstep PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_lockstep product)
set_tests_properties(several_robots PROPERTIES TIMEOUT 300)
handsel_test(place_reached GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/place_reached_test.cpp LINK handsel_lockstep LABEL system)
set_tests_properties(place_reached PROPERTIES TIMEOUT 1800)

# Latches over the death of processes: a few every time, HANDSEL_RUNS=5 for all.
handsel_test(latches GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/latches_test.cpp LINK handsel_command LABEL fault)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live product)
set_tests_properties(latches PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)

# Sources of people that fall silent, freeze, repeat nobody, are late or look elsewhere: each once every time, eight times for all.
handsel_test(blind GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/blind_test.cpp LINK handsel_command LABEL fault)
add_dependencies(tests_live product)
set_tests_properties(blind PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
handsel_test_again(blind_forty OF blind)
set_tests_properties(blind_forty PROPERTIES LABELS full RUN_SERIAL TRUE TIMEOUT 1800 ENVIRONMENT HANDSEL_RUNS=8)

# Long: trials of people who differ over real processes, and deaths at random.
handsel_test(exchanges GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/exchanges_test.cpp LINK handsel_command LABEL full)
add_dependencies(tests_live product)
set_tests_properties(exchanges PROPERTIES RUN_SERIAL TRUE TIMEOUT 14400)

handsel_test(supervised_life GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/supervised_life_test.cpp LINK handsel_command LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live product)
set_tests_properties(supervised_life PROPERTIES RUN_SERIAL TRUE TIMEOUT 240)

handsel_test(eval GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/eval_test.cpp LINK nlohmann_json::nlohmann_json GTest::gmock LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live handsel)
set_tests_properties(eval PROPERTIES TIMEOUT 180)

handsel_test(between_hands GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/between_hands_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live handsel)
set_tests_properties(between_hands PROPERTIES PROCESSORS 2 TIMEOUT 300)
handsel_test(passing GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/driving/passing_test.cpp LINK handsel_lockstep nlohmann_json::nlohmann_json LABEL system)
set_tests_properties(passing PROPERTIES TIMEOUT 300)
handsel_test(robot_drives GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/driving/robot_drives_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live handsel)
set_tests_properties(robot_drives PROPERTIES TIMEOUT 300)
handsel_test(carried_upright GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/carried_upright_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live handsel)
set_tests_properties(carried_upright PROPERTIES PROCESSORS 2 TIMEOUT 300)
