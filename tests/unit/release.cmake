# SPDX-License-Identifier: Apache-2.0
handsel_test(release_trials GROUP trajectory_controller SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/release_trials_test.cpp LINK handsel_trajectory_controller_core LABEL property)
