// SPDX-License-Identifier: Apache-2.0
#include "common/collision/margins.hpp"

#include <algorithm>

namespace handsel {

void set_scene_with_margins(CollisionWorld& world, const Scene& scene, const Margins& margins,
                            const std::vector<Vector>& ends) {
  for (const double ratio : {1.0, 0.3, 0.0}) {
    Scene wider = scene;
    for (SceneBox& box : wider.boxes) box.size += Vector3::Constant(2 * ratio * margins.boxes);
    world.set_scene(wider);
    world.set_turning_margin(ratio * margins.turning);
    if (std::all_of(ends.begin(), ends.end(), [&](const Vector& q) { return world.is_free(q); }))
      return;
  }
}

}  // namespace handsel
