# SPDX-License-Identifier: Apache-2.0
add_executable(test_probe ${CMAKE_CURRENT_LIST_DIR}/probe.cpp)
target_link_libraries(test_probe PRIVATE handsel_bus)
handsel_test(process GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/process_test.cpp LINK handsel_bus LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_PROBE="$<TARGET_FILE:test_probe>")
add_dependencies(tests_live test_probe)
set_tests_properties(process PROPERTIES RUN_SERIAL TRUE)
