# SPDX-License-Identifier: Apache-2.0
handsel_test(ros2 GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/ros2_test.cpp LINK handsel_bus handsel_ros2_idl LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
target_compile_options(tests_live PRIVATE -Wno-missing-field-initializers)
add_dependencies(tests_live product)
set_tests_properties(ros2 PROPERTIES RUN_SERIAL TRUE TIMEOUT 120)
