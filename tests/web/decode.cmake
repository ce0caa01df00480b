# SPDX-License-Identifier: Apache-2.0
# Raw CDR and IDL text as a viewer decodes them, live and from a recording. The npm packages are fetched once for each package-lock.json.
add_executable(samples ${CMAKE_CURRENT_LIST_DIR}/samples.cpp)
target_link_libraries(samples PRIVATE handsel_bus nlohmann_json::nlohmann_json)
target_compile_options(samples PRIVATE -Wno-missing-field-initializers)
set(npm_test ${CMAKE_CURRENT_LIST_DIR}/npm_test.sh)
add_test(NAME viewer_decodes_every_type
  COMMAND ${npm_test} decode_test.mjs $<TARGET_FILE:samples> $<TARGET_FILE:handsel_bridge_process>)
add_test(NAME viewer_reads_a_recording COMMAND ${npm_test} record_test.mjs $<TARGET_FILE:samples> $<TARGET_FILE:handsel>)
set_tests_properties(viewer_decodes_every_type viewer_reads_a_recording PROPERTIES LABELS system RUN_SERIAL TRUE TIMEOUT 120)
