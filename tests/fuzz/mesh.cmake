# SPDX-License-Identifier: Apache-2.0
handsel_test(mesh_fuzz SOURCES ${CMAKE_CURRENT_LIST_DIR}/mesh_fuzz.cpp LINK handsel_geometry LABEL fuzz)
