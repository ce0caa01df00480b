# SPDX-License-Identifier: Apache-2.0
handsel_test(driver_stories GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/driver_stories_test.cpp
  LINK handsel_fake_arms handsel_trajectory_controller_core LABEL property)
