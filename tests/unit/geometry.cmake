handsel_test(geometry SOURCES ${CMAKE_CURRENT_LIST_DIR}/geometry_test.cpp LINK handsel_geometry LABEL unit)
