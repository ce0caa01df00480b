# SPDX-License-Identifier: Apache-2.0
# Bullet in double precision: at a millisecond a step, single precision loses the small velocities of a held pose.
find_path(BULLET64_INCLUDE btBulletDynamicsCommon.h PATH_SUFFIXES bullet REQUIRED)
foreach(part BulletDynamics BulletCollision LinearMath)
  find_library(BULLET64_${part} ${part}-float64 REQUIRED)
endforeach()
add_library(handsel_bullet INTERFACE)
target_include_directories(handsel_bullet SYSTEM INTERFACE ${BULLET64_INCLUDE})
target_compile_definitions(handsel_bullet INTERFACE BT_USE_DOUBLE_PRECISION)
target_link_libraries(handsel_bullet INTERFACE ${BULLET64_BulletDynamics} ${BULLET64_BulletCollision} ${BULLET64_LinearMath})
