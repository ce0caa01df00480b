handsel_test(wire SOURCES ${CMAKE_CURRENT_LIST_DIR}/wire_test.cpp LINK handsel_wire nlohmann_json::nlohmann_json LABEL unit)
