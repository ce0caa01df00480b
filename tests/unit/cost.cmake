# SPDX-License-Identifier: Apache-2.0
handsel_test(cost GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/cost/cost_test.cpp ${CMAKE_CURRENT_LIST_DIR}/cost/cost_layers_test.cpp LINK handsel_cost LABEL unit)
handsel_test(cost_property GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/cost_property_test.cpp LINK handsel_cost LABEL unit)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_definitions(tests_common PRIVATE HANDSEL_SIMD_UNITS)
endif()
