# SPDX-License-Identifier: Apache-2.0
handsel_test(recording_fuzz SOURCES ${CMAKE_CURRENT_LIST_DIR}/recording_fuzz.cpp LINK handsel_sim_core LABEL fuzz)
