# Processes of their own, one arm after the other on one DDS domain.
handsel_test(first_day SOURCES ${CMAKE_CURRENT_LIST_DIR}/first_day_test.cpp LINK handsel_driver_process handsel_model handsel_trajectory LABEL system)
target_compile_definitions(test_first_day PRIVATE HANDSEL_BINARIES="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}" HANDSEL_TEST_DOMAIN=74)
target_compile_options(test_first_day PRIVATE -Wno-missing-field-initializers)
add_dependencies(test_first_day handsel_position_arm handsel_reflex_arm handsel_fake_arm handsel_trajectory_controller_process)
set_tests_properties(first_day PROPERTIES RUN_SERIAL TRUE TIMEOUT 900)
