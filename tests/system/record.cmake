# Real processes recorded, and what came in fed to others.
handsel_test(recorded_run SOURCES ${CMAKE_CURRENT_LIST_DIR}/recorded_run_test.cpp LINK handsel_command handsel_record LABEL system)
target_compile_definitions(test_recorded_run PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(test_recorded_run product)
set_tests_properties(recorded_run PROPERTIES RUN_SERIAL TRUE TIMEOUT 180)
