# SPDX-License-Identifier: Apache-2.0
# The example is built against what an install has for programs outside.
if(TARGET handsel_client)
  handsel_test(perception GROUP live FILTER "-PerceptionMore.*" SOURCES ${CMAKE_CURRENT_LIST_DIR}/perception_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
  target_compile_definitions(tests_live PRIVATE HANDSEL_BUILD_DIR="${CMAKE_BINARY_DIR}" HANDSEL_CMAKE="${CMAKE_COMMAND}")
  add_dependencies(tests_live deployable)
  set_tests_properties(perception PROPERTIES RUN_SERIAL TRUE TIMEOUT 240)
  handsel_test_again(perception_more OF perception FILTER "PerceptionMore.*")
  set_tests_properties(perception_more PROPERTIES LABELS full TIMEOUT 240)
endif()
