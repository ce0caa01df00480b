# SPDX-License-Identifier: Apache-2.0
# The libraries that other projects link, and what each consists of. Read by libraries_only.cmake and CMakeLists.txt.
set(HANDSEL_LIBRARY_NAMES trajectory grasp record model collision cost)

# <library>_folders: folders of common/ in the order of their dependencies. <library>_needs: libraries that must be there too.
# <library>_packages: what find_package() must find. <library>_requires: modules of pkg-config.
set(trajectory_folders trajectory)
set(trajectory_packages Eigen3)
set(trajectory_requires eigen3)
set(grasp_folders grasp)
set(grasp_packages Eigen3)
set(grasp_requires eigen3)
set(record_folders record)
set(record_packages Eigen3)
set(record_requires)
set(model_folders geometry messages config model)
set(model_needs trajectory)
set(model_packages Eigen3 Protobuf assimp tinyxml2 urdfdom bullet)
set(model_requires protobuf assimp tinyxml2 urdfdom bullet-float64)
set(collision_folders collision)
set(collision_needs trajectory model)
set(collision_packages fcl)
set(collision_requires fcl)
set(cost_folders cost)
set(cost_needs trajectory model collision)
set(cost_packages)
set(cost_requires)
# Targets of a library besides handsel_<library>, in the order in which a linker needs them.
set(model_targets config setting geometry messages)
