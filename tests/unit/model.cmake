handsel_test(model SOURCES ${CMAKE_CURRENT_LIST_DIR}/model_test.cpp ${CMAKE_CURRENT_LIST_DIR}/model_input_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/human_body_test.cpp ${CMAKE_CURRENT_LIST_DIR}/robot_capsules_test.cpp
             LINK handsel_model LABEL unit)
