handsel_test(costmap SOURCES ${CMAKE_CURRENT_LIST_DIR}/costmap_test.cpp LINK handsel_costmap_core LABEL unit)
