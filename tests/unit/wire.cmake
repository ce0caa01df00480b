# SPDX-License-Identifier: Apache-2.0
handsel_test(wire GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/bus/wire_test.cpp LINK handsel_bus nlohmann_json::nlohmann_json LABEL unit)
