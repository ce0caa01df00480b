// How comfortable a person's arm and wrist are when they take the object from the robot's hand.
// Own method: the arm model of common/model/human/human_wrist (ranges of joints, configuration of
// least strain), with poses of the hand that are made here from the contact of hand and object; no
// grasp of any planner is used.
#pragma once

#include <optional>

#include "common/messages/system.hpp"
#include "common/model/object_model.hpp"

namespace handsel::sim {

/// A person with a hand at the object.
struct Taker {
  const Person* body{};                   ///< ground truth; not null
  Side side{Side::right};                 ///< of that hand
  const ObjectModel* object{};            ///< not null
  Pose T_world_object{Pose::Identity()};  ///< where the object is
  Vector3 p_robot_palm{Vector3::Zero()};  ///< of the robot's hand, world [m]
};

/// Strain of an arm, as fractions of the ranges of its joints, [0, 1]; 1: at an end or beyond.
struct TakingStrain {
  double wrist{1};  ///< the largest of flexion, deviation and pronation
  double arm{1};    ///< the larger of elevation and adduction of the upper arm
};

/// Returns the strain of the arm that has its hand where the person's is: the fingers point to the
/// object or obliquely past it, close across its long axis if it is elongated, and keep clear of
/// the robot's palm. Of all such poses of the hand the one with the smallest strain counts; 1 each
/// where none serves.
TakingStrain taking_strain(const Taker& taker);

/// Measures at each release by the robot's hand to a person who has a hand at the object.
class TakingOracle {
 public:
  /// Takes in one physics step. `taker`: nullopt: no hand of a person is at the object.
  void observe(bool robot_grips, const std::optional<Taker>& taker);
  /// Writes taken, taking_side, taking_wrist_strain and taking_arm_strain.
  void write(GroundTruth& ground_truth) const;

 private:
  bool gripped_{false}, taken_{false};
  Side side_{Side::right};
  TakingStrain strain_;
};

}  // namespace handsel::sim
