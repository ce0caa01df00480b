// SPDX-License-Identifier: Apache-2.0
// Measures the comfort of a receiver's arm and wrist at the release by the robot's hand. Own
// method: the arm model of common/model/human/human_wrist (ranges of joints, configuration of min
// strain) with hand poses computed from the contact of hand and object, without any planner's
// grasps.
#pragma once

#include <optional>

#include "common/messages/system.hpp"
#include "common/model/object_model.hpp"

namespace handsel::sim {

/// A person with a hand on the object.
struct Taker {
  const Person* body{};                   ///< ground truth; not null
  Side side{Side::right};                 ///< side of that hand
  const ObjectModel* object{};            ///< not null
  Pose T_world_object{Pose::Identity()};  ///< pose of the object
  Vector3 p_robot_palm{Vector3::Zero()};  ///< palm of the robot's hand, world [m]
};

/// Strain of an arm as fractions of the ranges of its joints, [0, 1]; 1: at an end or beyond.
struct TakingStrain {
  double wrist{1};  ///< max of flexion, deviation and pronation
  double arm{1};    ///< max of elevation and adduction of the upper arm
};

/// Returns the min strain over all poses of the person's hand at its position: the fingers point to
/// the object or obliquely past the object, close across the long axis of an elongated object, and
/// keep a distance from the robot's palm. Returns 1 for both parts if no pose is possible.
TakingStrain taking_strain(const Taker& taker);

/// Measures at each release by the robot's hand to a person with a hand on the object.
class TakingOracle {
 public:
  /// Evaluates one physics step. `taker`: nullopt: no person's hand is on the object.
  void observe(bool robot_grips, const std::optional<Taker>& taker);
  /// Writes taken, taking_side, taking_wrist_strain and taking_arm_strain.
  void write(GroundTruth& ground_truth) const;

 private:
  bool gripped_{false}, taken_{false};
  Side side_{Side::right};
  TakingStrain strain_;
};

}  // namespace handsel::sim
