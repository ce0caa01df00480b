# SPDX-License-Identifier: Apache-2.0
handsel_test(spark_latency GROUP live SOURCES ${CMAKE_CURRENT_LIST_DIR}/spark_latency_test.cpp LINK handsel_bus handsel_model LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_SPARK="$<TARGET_FILE:handsel_spark_process>")
add_dependencies(tests_live handsel_spark_process)
set_tests_properties(spark_latency PROPERTIES RUN_SERIAL TRUE TIMEOUT 120)
