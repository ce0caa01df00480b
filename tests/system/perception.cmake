# The example is built against what an install has for programs outside.
if(TARGET handsel_client)
  handsel_test(perception SOURCES ${CMAKE_CURRENT_LIST_DIR}/perception_test.cpp LINK nlohmann_json::nlohmann_json LABEL system)
  target_compile_definitions(test_perception PRIVATE HANDSEL_BUILD_DIR="${CMAKE_BINARY_DIR}" HANDSEL_CMAKE="${CMAKE_COMMAND}")
  add_dependencies(test_perception deployable)
  set_tests_properties(perception PROPERTIES RUN_SERIAL TRUE TIMEOUT 240 ENVIRONMENT GTEST_FILTER=-PerceptionMore.*)
  add_test(NAME perception_more COMMAND test_perception)
  set_tests_properties(perception_more PROPERTIES LABELS full TIMEOUT 240 ENVIRONMENT GTEST_FILTER=PerceptionMore.*)
endif()
