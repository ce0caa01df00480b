# SPDX-License-Identifier: Apache-2.0
handsel_test(hand_prediction GROUP spark SOURCES ${CMAKE_CURRENT_LIST_DIR}/hand_prediction_test.cpp LINK handsel_spark_core handsel_sim_core LABEL unit)
handsel_test(people_tracker GROUP spark SOURCES ${CMAKE_CURRENT_LIST_DIR}/people_tracker_test.cpp LINK handsel_spark_core LABEL unit)
handsel_test_again(people_tracker_hundred OF people_tracker)
set_tests_properties(people_tracker_hundred PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT HANDSEL_RUNS=100)
