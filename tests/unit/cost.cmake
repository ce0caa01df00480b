handsel_test(cost SOURCES ${CMAKE_CURRENT_LIST_DIR}/cost_test.cpp LINK handsel_cost LABEL unit)
handsel_test(cost_property SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/cost_property_test.cpp LINK handsel_cost LABEL unit)
