handsel_test(guard SOURCES ${CMAKE_CURRENT_LIST_DIR}/guard_test.cpp LINK handsel_trajectory_controller_core LABEL unit)
handsel_test(controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/controller_test.cpp ${CMAKE_CURRENT_LIST_DIR}/hand_executor_test.cpp
  LINK handsel_trajectory_controller_core LABEL unit)
handsel_test(controller_stories SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/controller_stories_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../support/allocation_counter.cpp LINK handsel_trajectory_controller_core LABEL property)
handsel_test(separation_stories SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/separation_stories_test.cpp LINK handsel_trajectory_controller_core LABEL property)
