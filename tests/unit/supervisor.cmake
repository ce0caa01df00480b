handsel_test(supervisor SOURCES ${CMAKE_CURRENT_LIST_DIR}/supervisor_test.cpp LINK handsel_supervisor_core LABEL unit)
