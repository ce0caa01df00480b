# SPDX-License-Identifier: Apache-2.0
handsel_test(collision_checker GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/collision/collision_checker_test.cpp LINK handsel_collision_checker_core LABEL unit)
