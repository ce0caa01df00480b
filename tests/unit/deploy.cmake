handsel_test(launcher SOURCES ${CMAKE_CURRENT_LIST_DIR}/launcher_test.cpp LINK handsel_command LABEL unit)
handsel_test(story SOURCES ${CMAKE_CURRENT_LIST_DIR}/story_test.cpp LINK handsel_command LABEL unit)
handsel_test(includes SOURCES ${CMAKE_CURRENT_LIST_DIR}/includes_test.cpp LABEL unit)
handsel_test(docs SOURCES ${CMAKE_CURRENT_LIST_DIR}/docs_test.cpp LABEL unit)
