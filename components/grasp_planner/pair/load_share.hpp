// SPDX-License-Identifier: Apache-2.0
// A load on several hands at once: the grip force of each so that all together bear it. Own method.
// Pure.
#pragma once

#include <vector>

#include "common/grasp/grip_force.hpp"
#include "common/messages/planning.hpp"
#include "components/grasp_planner/hand/hand_geometry.hpp"

namespace handsel::grasp_planner {

/// A hand and its grasp of the load.
struct BearingHand {
  const HandGeometry* hand_geometry{};  ///< geometry of the hand
  const Grasp* grasp{};                 ///< its grasp of the load
};

/// The part of the load that one hand bears.
struct LoadShare {
  double margin{};  ///< as GripForces::margin; -infinity when its contacts bear nothing [N]
  Vector effort;    ///< of the hand's axes; empty when there is none worth reporting [Nm]
};

/// Returns the load of an object carried in this orientation, object frame: its weight, and in any
/// direction the force by which `settings.acceleration` exceeds gravity.
GripLoad carried_load(double mass, const Eigen::Matrix3d& R_world_object,
                      const GripForceSettings& settings);

/// Returns the part of the load of each hand, in the order of `hands`. `centre` of the load and its
/// directions: object frame.
std::vector<LoadShare> share_load(const std::vector<BearingHand>& hands, const Vector3& centre,
                                  const GripLoad& load, const GripForceSettings& settings);

/// Returns what one hand bears of the fraction `part` of the load, applied at the middle of its
/// contacts; the other hands prevent rotation.
LoadShare bear_part(const BearingHand& hand, double part, const GripLoad& load,
                    const GripForceSettings& settings);

}  // namespace handsel::grasp_planner
