# SPDX-License-Identifier: Apache-2.0
handsel_test(bus GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/bus/bus_test.cpp ${CMAKE_CURRENT_LIST_DIR}/bus/writer_pin_test.cpp ${CMAKE_CURRENT_LIST_DIR}/bus/paced_clock_test.cpp LINK handsel_bus LABEL unit)
