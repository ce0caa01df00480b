if(TARGET handsel_sim_core AND TARGET handsel_trajectory_controller_core)
  handsel_test(grasp_holds SOURCES ${CMAKE_CURRENT_LIST_DIR}/grasp_holds_test.cpp
    LINK handsel_grasp_planner_core handsel_trajectory_controller_core handsel_sim_core LABEL system)
endif()
