# SPDX-License-Identifier: Apache-2.0
handsel_test(transfer GROUP grasp_planner SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/transfer_test.cpp LINK handsel_grasp_planner_core LABEL unit)
handsel_test_again(transfer_all OF transfer)
set_tests_properties(transfer_all PROPERTIES LABELS full TIMEOUT 300 ENVIRONMENT "HANDSEL_TRANSFERS=all")
