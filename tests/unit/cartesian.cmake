# SPDX-License-Identifier: Apache-2.0
handsel_test(cartesian GROUP planning SOURCES ${CMAKE_CURRENT_LIST_DIR}/path_planner/cartesian_test.cpp LINK handsel_path_planner_core LABEL unit)
handsel_test_again(cartesian_100 OF cartesian FILTER "Cartesian.*jumps*")
set_tests_properties(cartesian_100 PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT "HANDSEL_QUERIES=100")
