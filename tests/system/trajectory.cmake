# SPDX-License-Identifier: Apache-2.0
handsel_test(trajectory_command GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_command_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live handsel)
