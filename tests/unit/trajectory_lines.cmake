# SPDX-License-Identifier: Apache-2.0
handsel_test(trajectory_lines GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory/trajectory_lines_test.cpp LINK handsel_batch handsel_wire LABEL unit)
