# SPDX-License-Identifier: Apache-2.0
handsel_test(install GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/install_test.cpp LINK handsel_bus LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_BUILD_DIR="${CMAKE_BINARY_DIR}" HANDSEL_CMAKE="${CMAKE_COMMAND}")
target_compile_options(tests_live PRIVATE -Wno-missing-field-initializers)
add_dependencies(tests_live deployable)
set_tests_properties(install PROPERTIES TIMEOUT 120)

# The example as its author would build it, but against this build: for two hosts.
if(EXISTS ${CMAKE_SOURCE_DIR}/examples/perception/perception.c)
  add_executable(handsel_perception_example ${CMAKE_SOURCE_DIR}/examples/perception/perception.c)
  target_link_libraries(handsel_perception_example PRIVATE handsel::idl m)
endif()
handsel_test(hosts GROUP live FILTER "OnHosts.*-*cut*" SOURCES ${CMAKE_CURRENT_LIST_DIR}/hosts_test.cpp LINK handsel_command LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live product)
set_tests_properties(hosts PROPERTIES RUN_SERIAL TRUE TIMEOUT 180)
handsel_test_again(hosts_mistakes OF hosts FILTER "Mistakes.*:*/Mistakes.*")  # a process of its own: the other one ends on a host that is gone
set_tests_properties(hosts_mistakes PROPERTIES LABELS system TIMEOUT 60)
if(TARGET handsel_perception_example)
  add_dependencies(tests_live handsel_perception_example)
  handsel_test_again(hosts_link OF hosts FILTER "OnHosts.*cut*")
  set_tests_properties(hosts_link PROPERTIES LABELS full RUN_SERIAL TRUE TIMEOUT 180)
endif()

add_test(NAME compose COMMAND ${CMAKE_CURRENT_LIST_DIR}/compose_test.sh)
set_tests_properties(compose PROPERTIES LABELS full RUN_SERIAL TRUE TIMEOUT 7200 SKIP_RETURN_CODE 77)
