handsel_test(trajectory SOURCES ${CMAKE_CURRENT_LIST_DIR}/min_time_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory_test.cpp ${CMAKE_CURRENT_LIST_DIR}/time_law_test.cpp ${CMAKE_CURRENT_LIST_DIR}/smooth_test.cpp ${CMAKE_CURRENT_LIST_DIR}/approximate_test.cpp
  LINK handsel_trajectory LABEL unit)
