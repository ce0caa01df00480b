# SPDX-License-Identifier: Apache-2.0
handsel_test(model GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/model/model_test.cpp ${CMAKE_CURRENT_LIST_DIR}/model/model_input_test.cpp ${CMAKE_CURRENT_LIST_DIR}/model/arm_reach_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/model/human_body_test.cpp ${CMAKE_CURRENT_LIST_DIR}/model/robot_capsules_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/model/driving_robot_test.cpp ${CMAKE_CURRENT_LIST_DIR}/model/holding_hand_test.cpp
             LINK handsel_model LABEL unit)
handsel_test(srs_arm_property GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/srs_arm_property_test.cpp LINK handsel_model
             nlohmann_json::nlohmann_json LABEL unit)
handsel_test_again(srs_arm_property_full OF srs_arm_property)
set_tests_properties(srs_arm_property_full PROPERTIES LABELS full ENVIRONMENT HANDSEL_POSES=100000)
