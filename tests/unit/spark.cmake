# SPDX-License-Identifier: Apache-2.0
handsel_test(spark GROUP spark SOURCES ${CMAKE_CURRENT_LIST_DIR}/spark/spark_test.cpp ${CMAKE_CURRENT_LIST_DIR}/spark/facts_test.cpp ${CMAKE_CURRENT_LIST_DIR}/spark/scene_model_test.cpp ${CMAKE_CURRENT_LIST_DIR}/spark/calibration_test.cpp ${CMAKE_CURRENT_LIST_DIR}/spark/adopt_test.cpp ${CMAKE_CURRENT_LIST_DIR}/spark/spark_views_test.cpp ${CMAKE_CURRENT_LIST_DIR}/spark/other_robots_test.cpp LINK handsel_spark_core LABEL unit)
handsel_test(spark_node GROUP spark SOURCES ${CMAKE_CURRENT_LIST_DIR}/spark/spark_node_test.cpp LINK handsel_spark LABEL unit)
