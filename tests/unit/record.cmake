# SPDX-License-Identifier: Apache-2.0
handsel_test(record GROUP deploy SOURCES ${CMAKE_CURRENT_LIST_DIR}/bus/record_test.cpp LINK handsel_command handsel_record LABEL unit)
