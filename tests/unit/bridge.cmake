# SPDX-License-Identifier: Apache-2.0
handsel_test(bridge_server GROUP bridge SOURCES ${CMAKE_CURRENT_LIST_DIR}/bridge_server_test.cpp LINK handsel_bridge LABEL unit)
handsel_test(bridge_viewer GROUP bridge SOURCES ${CMAKE_CURRENT_LIST_DIR}/bridge_viewer_test.cpp LINK handsel_bridge_core LABEL unit)
handsel_test(bridge_command GROUP bridge SOURCES ${CMAKE_CURRENT_LIST_DIR}/bridge_command_test.cpp LINK handsel_bridge_core LABEL unit)
