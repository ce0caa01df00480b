// Who or what holds an object: decided from geometry, grip sensors, the load of the robot's hands
// and the hands of people. Pure.
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

/// Assigns holders for one scene; refers to everything it is made of.
class HolderAssignment {
 public:
  /// What the holders are decided from.
  struct Inputs {
    const settings::SparkSettings& settings;  ///< distances and forces
    const ObjectLibrary& library;             ///< described models
    const std::vector<SceneBox>& boxes;       ///< fixed boxes
    const RobotPlacement& robot;              ///< located
    const HumanState& people;                 ///< as of now
  };
  explicit HolderAssignment(const Inputs& inputs) : in_(inputs) {}

  /// Gives each grip that was felt to the nearest hand.
  void attribute_grips(ObjectTrack& track) const;
  /// Decides who or what holds an object that is in sight or at rest.
  void assign(ObjectTrack& track) const;
  /// Moves an object that is out of sight in a person's hand with that hand. Returns whether it
  /// did.
  bool carry(ObjectTrack& track) const;

 private:
  std::optional<std::size_t> loaded_hand(const ObjectTrack& track) const;
  bool keep_gripped(SceneObject& object) const;
  bool is_in_hand_of_holder(const SceneObject& object) const;
  bool is_in_closed_hand(const ObjectTrack& track) const;
  const SceneBox* support_under(const SceneObject& object, double gap) const;

  Inputs in_;
};

}  // namespace handsel::spark
