handsel_test(attention SOURCES ${CMAKE_CURRENT_LIST_DIR}/attention_test.cpp LINK handsel_attention LABEL unit)
