handsel_test(transfer SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasps/transfer_test.cpp LINK handsel_grasp_planner_core LABEL unit)
add_test(NAME transfer_all COMMAND test_transfer)
set_tests_properties(transfer_all PROPERTIES LABELS full TIMEOUT 300 ENVIRONMENT "HANDSEL_TRANSFERS=all")
