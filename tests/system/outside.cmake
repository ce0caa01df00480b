# SPDX-License-Identifier: Apache-2.0
handsel_test(outside_tree GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/outside/outside_tree_test.cpp LINK handsel_command LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live product)
set_tests_properties(outside_tree PROPERTIES TIMEOUT 600)
handsel_test(own_object GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/outside/own_object_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live product)
set_tests_properties(own_object PROPERTIES TIMEOUT 600)
