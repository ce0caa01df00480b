// SPDX-License-Identifier: Apache-2.0
// Clearance of an arm in motion to obstacles. It covers the tracking error and the turning of the
// head meanwhile. Own method: narrow places get smaller margins instead of no motion.
#pragma once

#include <vector>

#include "common/collision/collision_world.hpp"

namespace handsel {

struct Margins {
  double boxes{};  ///< boxes of the scene are larger by this on every side [m]
  /// Links that are driven by other axes than those of the motion, e.g. the head, are larger by
  /// this [m].
  double turning{};
};

/// Sets the scene of a world whose moving axes, people and attachment are set already. The margins
/// are multiplied by the largest factor (1, 0.3 or 0) at which all configurations `ends` (all axes)
/// are free: a motion that begins near an obstacle must stay possible.
void set_scene_with_margins(CollisionWorld& world, const Scene& scene, const Margins& margins,
                            const std::vector<Vector>& ends);

}  // namespace handsel
