# Raw CDR and IDL text as a viewer decodes them. The npm packages are fetched once for each package-lock.json.
add_executable(samples ${CMAKE_CURRENT_LIST_DIR}/samples.cpp)
target_link_libraries(samples PRIVATE handsel_bus nlohmann_json::nlohmann_json)
target_compile_options(samples PRIVATE -Wno-missing-field-initializers)
add_test(NAME viewer_decodes_every_type
  COMMAND ${CMAKE_CURRENT_LIST_DIR}/decode_test.sh $<TARGET_FILE:samples> $<TARGET_FILE:handsel_bridge_process>)
set_tests_properties(viewer_decodes_every_type PROPERTIES LABELS system RUN_SERIAL TRUE TIMEOUT 120)
