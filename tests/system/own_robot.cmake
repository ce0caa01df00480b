# SPDX-License-Identifier: Apache-2.0
handsel_test(own_robot GROUP lockstep FILTER "Robots/OwnRobot.lacks*:OwnRobotFolder.*" SOURCES ${CMAKE_CURRENT_LIST_DIR}/own_robot_test.cpp LINK handsel_lockstep LABEL system)
target_compile_definitions(tests_lockstep PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_lockstep handsel)
set_tests_properties(own_robot PROPERTIES TIMEOUT 300)
handsel_test_again(own_robot_ten OF own_robot FILTER "Robots/OwnRobotTen.*")
set_tests_properties(own_robot_ten PROPERTIES LABELS full TIMEOUT 1800)
