# SPDX-License-Identifier: Apache-2.0
# In virtual time: nothing depends on how fast the machine is.
handsel_test(flood GROUP lockstep SOURCES ${CMAKE_CURRENT_LIST_DIR}/flood_test.cpp LINK handsel_spark handsel_supervisor handsel_path_planner
             handsel_trajectory_planner LABEL system)
set_tests_properties(flood PROPERTIES TIMEOUT 300)
