handsel_test(spark SOURCES ${CMAKE_CURRENT_LIST_DIR}/spark_test.cpp ${CMAKE_CURRENT_LIST_DIR}/facts_test.cpp ${CMAKE_CURRENT_LIST_DIR}/scene_model_test.cpp ${CMAKE_CURRENT_LIST_DIR}/calibration_test.cpp ${CMAKE_CURRENT_LIST_DIR}/adopt_test.cpp LINK handsel_spark_core LABEL unit)
handsel_test(spark_node SOURCES ${CMAKE_CURRENT_LIST_DIR}/spark_node_test.cpp LINK handsel_spark LABEL unit)
