handsel_test(collision SOURCES ${CMAKE_CURRENT_LIST_DIR}/collision_test.cpp ${CMAKE_CURRENT_LIST_DIR}/collision_world_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/held_object_test.cpp LINK handsel_collision
             LABEL unit)
handsel_test(collision_property SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/collision_property_test.cpp LINK handsel_collision LABEL unit)
