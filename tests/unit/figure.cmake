# SPDX-License-Identifier: Apache-2.0
handsel_test(corner_figure SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory/figure_test.cpp LINK handsel_trajectory LABEL unit)
