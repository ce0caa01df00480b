# SPDX-License-Identifier: Apache-2.0
# The page: its types, and what it shows of a running system in a headless browser. build.sh all installs what they need.
find_program(HANDSEL_NODE node)
if(HANDSEL_NODE)
  set(web ${CMAKE_SOURCE_DIR}/components/bridge/web)
  add_test(NAME page_types COMMAND ${HANDSEL_NODE} ${web}/node_modules/typescript/bin/tsc -p ${web})
  add_test(NAME page_history COMMAND ${HANDSEL_NODE} ${CMAKE_CURRENT_LIST_DIR}/history_test.mjs)
  set_tests_properties(page_types page_history PROPERTIES LABELS unit)
  add_test(NAME page COMMAND ${HANDSEL_NODE} ${CMAKE_CURRENT_LIST_DIR}/page_test.mjs)
  add_test(NAME page_steers COMMAND ${HANDSEL_NODE} ${CMAKE_CURRENT_LIST_DIR}/steer_test.mjs)
  add_test(NAME page_recording COMMAND ${HANDSEL_NODE} ${CMAKE_CURRENT_LIST_DIR}/recording_test.mjs)
  add_test(NAME page_time COMMAND ${HANDSEL_NODE} ${CMAKE_CURRENT_LIST_DIR}/time_test.mjs)
  set_tests_properties(page page_recording page_steers page_time PROPERTIES LABELS system RUN_SERIAL TRUE TIMEOUT 420 ENVIRONMENT HANDSEL_BIN=$<TARGET_FILE_DIR:handsel>)
  # The live time axis: the order of a busy page and of the recorder is not settled yet.
  set_tests_properties(page_time PROPERTIES LABELS full)
endif()
