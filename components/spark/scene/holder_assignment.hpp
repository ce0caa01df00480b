// SPDX-License-Identifier: Apache-2.0
// Decides the holder of an object from geometry, grip sensors, the load of the robot's hands and
// the hands of people. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"
#include "components/spark/scene/object_track.hpp"
#include "components/spark/scene/robot_placement.hpp"

namespace handsel::spark {

/// Assigns holders for one scene; keeps references to its inputs.
class HolderAssignment {
 public:
  /// Inputs of the decision.
  struct Inputs {
    const settings::SparkSettings& settings;  ///< distances and forces
    const ObjectLibrary& library;             ///< described models
    const std::vector<SceneBox>& boxes;       ///< fixed boxes
    const RobotPlacement& robot;              ///< after locate()
    const HumanState& people;                 ///< present state
  };
  explicit HolderAssignment(const Inputs& inputs) : in_(inputs) {}

  /// Assigns each measured grip to the nearest hand.
  void attribute_grips(ObjectTrack& track) const;
  /// Assigns the holder of an object that is observed or at rest.
  void assign(ObjectTrack& track) const;
  /// Moves an unobserved object in a person's hand with that hand. Returns whether the object was
  /// moved.
  bool carry(ObjectTrack& track) const;

 private:
  std::optional<std::size_t> loaded_hand(const ObjectTrack& track) const;
  bool assign_by_grip(SceneObject& object) const;
  bool is_in_hand_of_holder(const SceneObject& object) const;
  bool is_in_closed_hand(const ObjectTrack& track) const;
  const SceneBox* support_under(const SceneObject& object, double gap) const;

  Inputs in_;
};

}  // namespace handsel::spark
