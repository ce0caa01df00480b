handsel_test(bus SOURCES ${CMAKE_CURRENT_LIST_DIR}/bus_test.cpp ${CMAKE_CURRENT_LIST_DIR}/writer_pin_test.cpp ${CMAKE_CURRENT_LIST_DIR}/paced_clock_test.cpp LINK handsel_bus LABEL unit)
