handsel_test(hand_prediction SOURCES ${CMAKE_CURRENT_LIST_DIR}/hand_prediction_test.cpp LINK handsel_spark_core handsel_sim_core LABEL unit)
