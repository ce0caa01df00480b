# SPDX-License-Identifier: Apache-2.0
# Processes of their own, one arm after the other on one DDS domain.
handsel_test(first_day GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/first_day_test.cpp LINK handsel_driver_process handsel_model handsel_trajectory LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_BINARIES="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}" HANDSEL_TEST_DOMAIN=219)
target_compile_options(tests_live PRIVATE -Wno-missing-field-initializers)
add_dependencies(tests_live handsel_position_arm handsel_reflex_arm handsel_fake_arm handsel_trajectory_controller_process)
set_tests_properties(first_day PROPERTIES TIMEOUT 900)
