# SPDX-License-Identifier: Apache-2.0
handsel_test(costmap GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/cost/costmap_test.cpp LINK handsel_costmap_core LABEL unit)
handsel_test(cost_grid_property GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/cost_grid_property_test.cpp LINK handsel_costmap_core LABEL unit)
