# SPDX-License-Identifier: Apache-2.0
handsel_test(attention GROUP attention SOURCES ${CMAKE_CURRENT_LIST_DIR}/attention_test.cpp LINK handsel_attention LABEL unit)
handsel_test(margin_clock GROUP attention SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/margin_clock_test.cpp LINK handsel_attention_core LABEL unit)
handsel_test(sensor_request GROUP attention SOURCES ${CMAKE_CURRENT_LIST_DIR}/sensor_request_test.cpp LINK handsel_attention_core LABEL unit)
handsel_test(object_search GROUP attention SOURCES ${CMAKE_CURRENT_LIST_DIR}/object_search_test.cpp LINK handsel_attention LABEL unit)
