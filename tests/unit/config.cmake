# SPDX-License-Identifier: Apache-2.0
handsel_test(config GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/config_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/config/scenario_test.cpp ${CMAKE_CURRENT_LIST_DIR}/config/settings_test.cpp ${CMAKE_CURRENT_LIST_DIR}/config/settings_documents_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/config/overlay_test.cpp ${CMAKE_CURRENT_LIST_DIR}/config/search_path_test.cpp
  LINK handsel_config handsel_messages LABEL unit)
