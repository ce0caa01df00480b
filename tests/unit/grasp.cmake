find_package(Qhull REQUIRED CONFIG)
handsel_test(grasp SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasp_test.cpp LINK handsel_grasp_planner_core LABEL unit)
handsel_test(grasp_list SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasp_list_test.cpp LINK handsel_grasp_planner_core LABEL unit)
handsel_test(grasp_stability SOURCES ${CMAKE_SOURCE_DIR}/tests/property/grasp_stability_test.cpp LINK handsel_grasp_planner_core Qhull::qhull_r LABEL unit)
