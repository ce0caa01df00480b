# SPDX-License-Identifier: Apache-2.0
handsel_test(collision GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/collision/collision_test.cpp ${CMAKE_CURRENT_LIST_DIR}/collision/collision_world_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/manipulation_planner/held_object_test.cpp LINK handsel_collision
             LABEL unit)
handsel_test(collision_property GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/collision_property_test.cpp LINK handsel_collision LABEL unit)
handsel_test(wide_collision GROUP common SOURCES ${CMAKE_CURRENT_LIST_DIR}/collision/batch_collision_test.cpp LINK handsel_collision nlohmann_json::nlohmann_json LABEL unit)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_definitions(tests_common PRIVATE HANDSEL_SIMD_UNITS)
endif()
handsel_test_again(wide_collision_million OF wide_collision FILTER "WideCollision.*")
set_tests_properties(wide_collision_million PROPERTIES LABELS full TIMEOUT 1800 ENVIRONMENT "HANDSEL_WIDE_STATES=1000000")
