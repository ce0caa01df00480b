handsel_test(left_out SOURCES ${CMAKE_CURRENT_LIST_DIR}/left_out_test.cpp LINK handsel_bus LABEL unit)
handsel_test(garbage SOURCES ${CMAKE_CURRENT_LIST_DIR}/garbage_test.cpp LINK handsel_bus LABEL unit)
handsel_test(quotas SOURCES ${CMAKE_CURRENT_LIST_DIR}/quotas_test.cpp LINK handsel_spark_core LABEL unit)
handsel_test(queues SOURCES ${CMAKE_CURRENT_LIST_DIR}/queues_test.cpp LINK handsel_supervisor_core LABEL unit)
