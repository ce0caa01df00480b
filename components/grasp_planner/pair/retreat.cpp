// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/pair/retreat.hpp"

#include <cmath>
#include <numbers>

namespace handsel::grasp_planner {

std::vector<Vector3> retreat_directions(const HandModel& hand) {
  const Vector3 away = -hand.T_hand_grasp().translation().normalized();
  const Vector3 side = away.unitOrthogonal(), other = away.cross(side);
  std::vector<Vector3> directions{away};
  for (const double tilt : {0.45, 0.9}) {
    for (int k = 0; k < 6; ++k) {
      const double turn = std::numbers::pi / 3 * k;
      directions.push_back(std::cos(tilt) * away +
                           std::sin(tilt) * (std::cos(turn) * side + std::sin(turn) * other));
    }
  }
  return directions;
}

bool retreat_free(const HandGeometry& hand_geometry,
                  const std::vector<std::vector<Pose>>& T_hand_step, const Graspable& object,
                  const Pose& T_object_hand, const RetreatPath& path, std::uint64_t* tests) {
  const int poses = static_cast<int>(std::ceil(path.length / (2 * kSweepStep)));
  for (int k = 0; k < poses; ++k) {
    Pose T = T_object_hand;
    T.translate(Vector3((path.length - 2 * k * kSweepStep) * path.direction));
    if (tests != nullptr) ++*tests;
    if (hand_geometry.shape.touches(T_hand_step, object, T, path.clearance)) return false;
  }
  return true;
}

}  // namespace handsel::grasp_planner
