// Clearance of an arm in motion to what it passes: it is not exactly where it is commanded to be,
// and the head turns meanwhile. Own method: narrow places get smaller margins instead of no motion.
#pragma once

#include <vector>

#include "common/collision/collision_world.hpp"

namespace handsel {

struct Margins {
  double boxes{};    ///< boxes of the scene are larger by this on every side [m]
  double turning{};  ///< and links that axes beside the moving ones turn [m]
};

/// Puts the scene into the world with the margins, or with the largest fraction of them (1, 0.3 or
/// 0) at which `ends` (all axes) are free: a motion that begins near an obstacle must stay
/// possible. The scene itself, moving axes, people and attachment are set before.
void set_scene_with_margins(CollisionWorld& world, const Scene& scene, const Margins& margins,
                            const std::vector<Vector>& ends);

}  // namespace handsel
