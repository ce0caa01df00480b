// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/head_room.hpp"

#include <algorithm>

#include "common/model/human/human_body.hpp"

namespace handsel::path_planner {

double keep_clear_of_heads(CollisionWorld& world, const HumanState& people, double room,
                           const Vector& start, const std::vector<Vector>& goals) {
  constexpr int kParts = 6;  // number of fractions tried
  for (int part = room > 0 ? kParts : 0; part > 0; --part) {
    const double clearance = room * part / kParts;
    std::vector<Obstacle> heads;
    for (const Person& person : people.people) {
      if (person.joints.empty()) continue;
      const SimplifiedBody body = simplified_body(person);
      Obstacle head{"about the head of " + person.id, {}};
      head.placed.shape = Sphere{body.head_radius + clearance};
      head.placed.T_parent_shape = make_pose(body.head, Eigen::Quaterniond::Identity());
      heads.push_back(std::move(head));
    }
    world.set_obstacles(heads);
    if (heads.empty()) return 0;
    if (world.is_free(start) &&
        std::any_of(goals.begin(), goals.end(), [&](const Vector& q) { return world.is_free(q); }))
      return clearance;
  }
  world.set_obstacles({});
  return 0;
}

}  // namespace handsel::path_planner
