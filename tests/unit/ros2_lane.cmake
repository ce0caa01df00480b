# SPDX-License-Identifier: Apache-2.0
handsel_test(ros2_lane GROUP bridge SOURCES ${CMAKE_CURRENT_LIST_DIR}/ros2_lane_test.cpp LINK handsel_ros2_lane LABEL unit)
