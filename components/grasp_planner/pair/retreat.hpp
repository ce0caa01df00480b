// SPDX-License-Identifier: Apache-2.0
// How an opened hand backs off from an object, or comes to it along the same path in reverse. Own
// method.
#pragma once

#include <cstdint>
#include <vector>

#include "components/grasp_planner/hand/hand_geometry.hpp"
#include "components/grasp_planner/object/graspable.hpp"

namespace handsel::grasp_planner {

inline constexpr double kSweepStep = 0.008;  ///< distance of two tests along a straight path [m]

/// Returns unit vectors in the hand frame: straight away from where contacts happen, then a cone of
/// directions around it.
std::vector<Vector3> retreat_directions(const HandModel& hand);

/// A straight path of the opened hand away from its grasp.
struct RetreatPath {
  Vector3 direction{Vector3::UnitZ()};  ///< unit, hand frame
  double length{};                      ///< [m]
  double clearance{};                   ///< kept to the object [m]
};

/// Returns whether the opened hand (`T_hand_step`) can follow the path and keep its clearance. The
/// place it starts from is not checked. `tests`: the number of tests made is added.
bool retreat_free(const HandGeometry& hand_geometry,
                  const std::vector<std::vector<Pose>>& T_hand_step, const Graspable& object,
                  const Pose& T_object_hand, const RetreatPath& path,
                  std::uint64_t* tests = nullptr);

}  // namespace handsel::grasp_planner
