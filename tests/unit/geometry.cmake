# SPDX-License-Identifier: Apache-2.0
handsel_test(geometry GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/geometry_test.cpp LINK handsel_geometry LABEL unit)
handsel_test(placement GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/geometry/placement_test.cpp LINK handsel_geometry handsel_model LABEL unit)
handsel_test(solid GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/geometry/solid_test.cpp LINK handsel_geometry LABEL unit)
