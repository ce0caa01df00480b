handsel_test(geometry SOURCES ${CMAKE_CURRENT_LIST_DIR}/geometry_test.cpp LINK handsel_geometry LABEL unit)
handsel_test(placement SOURCES ${CMAKE_CURRENT_LIST_DIR}/geometry/placement_test.cpp LINK handsel_geometry handsel_model LABEL unit)
handsel_test(solid SOURCES ${CMAKE_CURRENT_LIST_DIR}/geometry/solid_test.cpp LINK handsel_geometry LABEL unit)
