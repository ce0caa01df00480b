# SPDX-License-Identifier: Apache-2.0
handsel_test(external_person GROUP sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim/external_person_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(perception_review GROUP spark SOURCES ${CMAKE_CURRENT_LIST_DIR}/spark/perception_review_test.cpp LINK handsel_perception_review LABEL unit)
target_compile_options(tests_spark PRIVATE -Wno-missing-field-initializers)
