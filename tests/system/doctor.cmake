# SPDX-License-Identifier: Apache-2.0
add_library(handsel_clock_jump MODULE ${CMAKE_CURRENT_LIST_DIR}/../support/clock_jump.cpp)
target_link_libraries(handsel_clock_jump PRIVATE handsel_options)
handsel_test(doctor GROUP live FILTER "-*beside*:*port*" SOURCES ${CMAKE_CURRENT_LIST_DIR}/doctor_test.cpp LINK handsel_bus nlohmann_json::nlohmann_json LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>" HANDSEL_CLOCK_JUMP="$<TARGET_FILE:handsel_clock_jump>")
target_compile_options(tests_live PRIVATE -Wno-missing-field-initializers)
add_dependencies(tests_live product handsel_clock_jump)
# Beside a running system it runs alone; the other faults wait more than they compute.
set_tests_properties(doctor PROPERTIES TIMEOUT 300)
handsel_test_again(doctor_system OF doctor FILTER "Doctor.*beside*:Doctor.*port*")
set_tests_properties(doctor_system PROPERTIES LABELS system RUN_SERIAL TRUE TIMEOUT 120)
