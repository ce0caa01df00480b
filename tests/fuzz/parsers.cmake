# SPDX-License-Identifier: Apache-2.0
handsel_test(model_fuzz SOURCES ${CMAKE_CURRENT_LIST_DIR}/model_fuzz.cpp LINK handsel_model LABEL fuzz)
handsel_test(text_fuzz SOURCES ${CMAKE_CURRENT_LIST_DIR}/text_fuzz.cpp LINK handsel_command LABEL fuzz)
handsel_test(mcap_fuzz SOURCES ${CMAKE_CURRENT_LIST_DIR}/mcap_fuzz.cpp LINK handsel_record LABEL fuzz)
