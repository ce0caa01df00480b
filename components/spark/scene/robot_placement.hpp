// SPDX-License-Identifier: Apache-2.0
// Poses of the robot, its links and its hands from its reported state. Pure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/messages/robot.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::spark {

/// Returns the box within reach of a robot at `base`, with a margin, in which people must be
/// observed [m].
Coverage reach_of(const RobotModel& robot, const Vector3& base);

/// Configuration and base pose of the robot, with the poses of links and hands.
class RobotPlacement {
 public:
  /// A hand of the robot.
  struct Hand {
    std::string name;                     ///< as SceneObject::holder_id; empty for the first
    int palm{-1};                         ///< link of the palm; -1: none
    double payload{};                     ///< measured [kg]
    Pose T_world_palm{Pose::Identity()};  ///< as of the last locate()
    /// Positions of the finger axes as of the last locate() [rad]; for a prismatic axis the
    /// rotation of a finger of 5 cm with the same motion of the tip. Empty: no finger axes.
    Vector fingers;
    std::vector<int> axes;  ///< finger axes
  };

  explicit RobotPlacement(std::shared_ptr<const RobotModel> robot);

  /// Takes the state of the same robot.
  void update(const RobotState& state);
  /// Computes the poses of links and hands from the last state.
  void locate();

  /// Returns the model of the robot.
  const RobotModel& model() const { return *robot_; }
  /// Returns whether update() was called.
  bool known() const { return known_; }
  /// Returns the configuration of the last update().
  const Vector& position() const { return position_; }
  /// Returns the base pose of the last update(); identity before.
  const Pose& T_world_base() const { return T_world_base_; }
  /// Returns the hands, never empty; the first is that of the tool link.
  const std::vector<Hand>& hands() const { return hands_; }
  /// Returns the poses of the links in the base frame as of the last locate(); empty before
  /// update().
  const std::vector<Pose>& links() const { return links_; }
  /// Returns the box around all points within the robot's reach.
  Coverage reach() const;

 private:
  double angle_of(int axis) const;

  std::shared_ptr<const RobotModel> robot_;
  bool known_{false};
  Vector position_;
  Pose T_world_base_{Pose::Identity()};
  std::vector<Hand> hands_;
  std::vector<Pose> links_;
  double arm_length_{1.0};  // [m]
};

}  // namespace handsel::spark
