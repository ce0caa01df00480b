// SPDX-License-Identifier: Apache-2.0
// Whether a robot can hand over what it holds from a place of its platform. Own method. Pure.
#pragma once

#include "components/manipulation_planner/handover/otp_search.hpp"

namespace handsel::manipulation_planner {

/// What is handed over to whom.
struct HandoverNeeds {
  Person receiver;   ///< as they are now
  Vector q;          ///< all axes as the robot arrives, except its platform's [rad, m]
  LayersNow layers;  ///< cost layers
  int palm{-1};      ///< link of the hand that holds the object
  Pose T_palm_object{Pose::Identity()};  ///< how the hand holds the object
  std::vector<Vector3> barred;           ///< as barred_directions() returns them
  std::vector<PartnerGrasp> partners;    ///< grasps of the person; empty: not known
  std::optional<Vector3> back{};         ///< see OtpQuery
};

/// Returns whether an object transfer point is within reach with the platform at `place`: x, y [m],
/// heading [rad] in the root frame.
bool can_hand_over_from(const Vector3& place, const HandoverNeeds& needs, const RobotModel& robot,
                        const Group& arm, const Scene& scene,
                        const settings::ManipulationPlannerSettings& settings);

}  // namespace handsel::manipulation_planner
