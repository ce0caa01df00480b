handsel_test(outside_tree SOURCES ${CMAKE_CURRENT_LIST_DIR}/outside/outside_tree_test.cpp LINK handsel_command LABEL system)
target_compile_definitions(test_outside_tree PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_outside_tree product)
set_tests_properties(outside_tree PROPERTIES TIMEOUT 600)
