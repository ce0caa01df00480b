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

/// What one of them has to do.
struct LoadShare {
  double margin{};  ///< as GripForces::margin; -infinity when its contacts bear nothing [N]
  Vector effort;    ///< of the hand's axes; empty when there is none worth reporting [Nm]
};

/// The load of an object that is carried in this turn, object frame: its weight is always there,
/// what `settings.acceleration` exceeds gravity by may come from any side.
GripLoad carried_load(double mass, const Eigen::Matrix3d& R_world_object,
                      const GripForceSettings& settings);

/// Returns what each hand has to do, in the order of `hands`. `centre` of the load and its
/// directions: object frame.
std::vector<LoadShare> share_load(const std::vector<BearingHand>& hands, const Vector3& centre,
                                  const GripLoad& load, const GripForceSettings& settings);

/// What one hand bears by itself when the others see to it that nothing turns: this part of the
/// load, in the middle of its contacts.
LoadShare bear_part(const BearingHand& hand, double part, const GripLoad& load,
                    const GripForceSettings& settings);

}  // namespace handsel::grasp_planner
