// SPDX-License-Identifier: Apache-2.0
// Where a robot offers an object that it holds with both hands: object transfer points ranked by
// the costs of the person (chapter sections 3.2.9 and 4.1.2) and the reach of both arms. Own
// method: the object is turned with its long axis across the direction to the person. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/config/settings/manipulation_planner.hpp"
#include "components/manipulation_planner/handover/otp_search.hpp"

namespace handsel::manipulation_planner {

/// An arm of the robot.
struct ArmPlace {
  Vector3 p_shoulder{Vector3::Zero()};  ///< world [m]
  double reach{};                       ///< max distance of the hand from the shoulder [m]
};

/// What is offered to whom; what is referred to must outlive the query.
struct TwoHandOtpQuery {
  const Scene& scene;                ///< furniture and base of the robot
  const Person& person;              ///< the receiver
  const LayersNow& layers;           ///< cost layers
  Pose T_world_object;               ///< where the object is now
  Eigen::AlignedBox3d extent;        ///< of the object in its frame [m]
  std::vector<ArmPlace> arms;        ///< of the robot, two
  Vector3 p_robot{Vector3::Zero()};  ///< where the robot stands, world [m]
};

/// Poses in which both hands offer an object, or why there are none.
struct TwoHandOtp {
  std::vector<Pose> T_world_object;  ///< the best first, `two_hand_otp_apart` from each other
  std::string reason;                ///< when there is none, one sentence
};

/// Searches object transfer points for both hands, at most `two_hand_exchange_goals`. The object
/// keeps its tilt. The ends of its long axis are within reach of the arms, none of its extent is
/// nearer to furniture than `two_hand_furniture_gap`. Inverse kinematics is not solved here.
TwoHandOtp find_two_hand_otp(const TwoHandOtpQuery& query,
                             const settings::ManipulationPlannerSettings& settings);

}  // namespace handsel::manipulation_planner
