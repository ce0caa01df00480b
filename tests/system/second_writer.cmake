# SPDX-License-Identifier: Apache-2.0
handsel_test(second_writer GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/second_writer_test.cpp LINK handsel_command LABEL system)
add_dependencies(tests_live product)
set_tests_properties(second_writer PROPERTIES TIMEOUT 180)
handsel_test_again(second_writer_five OF second_writer)
set_tests_properties(second_writer_five PROPERTIES LABELS full RUN_SERIAL TRUE TIMEOUT 3600 ENVIRONMENT HANDSEL_RUNS=5)
