// Where the robot, its links and its hands are, as it reports. Pure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/messages/robot.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::spark {

/// Where a robot at `base` could reach, and some more: the room in which people must be watched
/// [m].
Coverage reach_of(const RobotModel& robot, const Vector3& base);

/// Configuration and base pose of the robot, and what follows from them.
class RobotPlacement {
 public:
  /// A hand of the robot.
  struct Hand {
    std::string name;                     ///< as SceneObject::holder_id; empty for the first
    int palm{-1};                         ///< link; -1: none
    double payload{};                     ///< felt [kg]
    Pose T_world_palm{Pose::Identity()};  ///< as of the last locate()
    /// Positions of its finger axes as of the last locate() [rad]; of one that slides the turn of a
    /// finger of 5 cm that moves its tip as far. Empty: the hand has none.
    Vector fingers;
    std::vector<int> axes;  ///< its finger axes
  };

  explicit RobotPlacement(std::shared_ptr<const RobotModel> robot);

  /// Takes the state of the robot, which must be this one's.
  void update(const RobotState& state);
  /// Computes the poses of links and hands from the last state.
  void locate();

  /// Model of the robot.
  const RobotModel& model() const { return *robot_; }
  /// Returns whether update() was called.
  bool known() const { return known_; }
  /// Configuration of the last update().
  const Vector& position() const { return position_; }
  /// Base pose of the last update(); identity before.
  const Pose& T_world_base() const { return T_world_base_; }
  /// Hands, never empty; the first is that of the tool link.
  const std::vector<Hand>& hands() const { return hands_; }
  /// Poses of the links in the base frame as of the last locate(); empty before the robot is known.
  const std::vector<Pose>& links() const { return links_; }
  /// The box around everything the robot can reach.
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
