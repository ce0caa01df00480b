# SPDX-License-Identifier: Apache-2.0
handsel_test(left_out GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/bus/left_out_test.cpp LINK handsel_bus LABEL unit)
handsel_test(garbage GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/bus/garbage_test.cpp LINK handsel_bus LABEL unit)
handsel_test(quotas GROUP spark SOURCES ${CMAKE_CURRENT_LIST_DIR}/spark/quotas_test.cpp LINK handsel_spark_core LABEL unit)
handsel_test(queues GROUP supervisor SOURCES ${CMAKE_CURRENT_LIST_DIR}/bus/queues_test.cpp LINK handsel_supervisor_core LABEL unit)
