handsel_test(trajectory_command SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory_command_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(test_trajectory_command PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_trajectory_command handsel)
