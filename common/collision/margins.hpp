// How far an arm in motion keeps off what it passes: it is not exactly where it is told to be, and the head turns meanwhile. Ours.
#pragma once

#include <vector>

#include "common/collision/collision_world.hpp"

namespace handsel {

struct Margins {
  double boxes{};    ///< boxes of the scene are larger by this on every side [m]
  double turning{};  ///< and links that axes beside the moving ones turn [m]
};

/// Puts the scene into the world with the margins, or with the largest share of them at which `ends` (all axes) are free: from where
/// something stands near it must be possible to go away. The scene itself, moving axes, people and attachment are set
/// before.
void set_scene_with_margins(CollisionWorld& world, const Scene& scene, const Margins& margins, const std::vector<Vector>& ends);

}  // namespace handsel
