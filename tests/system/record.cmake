# SPDX-License-Identifier: Apache-2.0
# Real processes recorded, and what came in fed to others.
handsel_test(recorded_run GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/recorded_run_test.cpp LINK handsel_command handsel_record LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live product)
set_tests_properties(recorded_run PROPERTIES TIMEOUT 180)
