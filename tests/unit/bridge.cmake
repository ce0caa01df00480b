handsel_test(bridge_page SOURCES ${CMAKE_CURRENT_LIST_DIR}/bridge_page_test.cpp LINK handsel_bridge LABEL unit)
handsel_test(bridge_view SOURCES ${CMAKE_CURRENT_LIST_DIR}/bridge_view_test.cpp LINK handsel_bridge_core handsel_config LABEL unit)
