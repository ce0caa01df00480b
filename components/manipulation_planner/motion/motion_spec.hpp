// SPDX-License-Identifier: Apache-2.0
// What a motion of the arm or the platform is to do, and what ends it.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/messages/planning.hpp"
#include "common/messages/task.hpp"
#include "components/manipulation_planner/handover/receiver_hands.hpp"
#include "components/manipulation_planner/motion/motion_end.hpp"

namespace handsel::manipulation_planner {

/// An object that the goals of a motion depend on.
struct ObjectTarget {
  std::string object;                ///< scene object id
  Vector3 p_world{Vector3::Zero()};  ///< where it was when the goals were chosen, world [m]
  double max_shift{};                ///< the motion ends when it has moved farther [m]
  /// The moving arm follows the object to where this grasp is then; nullopt: it does not follow.
  std::optional<Grasp> grasp;
};

/// A person to whom an object is carried: the goals change when the person moves.
struct ReceiverTarget {
  std::string person;                      ///< id
  Vector3 p_world_torso{Vector3::Zero()};  ///< when the goals were chosen, world [m]
  Vector3 facing{Vector3::UnitX()};        ///< of the torso then: level, unit, world
  ReceiverHands hands{};                   ///< then
};

/// Shape of a motion between its ends.
enum class MotionShape : std::uint8_t {
  free,           ///< as the path planner finds it; replanned while it runs
  straight_axes,  ///< straight motion of the axes
  straight_tool,  ///< straight motion of the tool where the arm permits it, else of the axes
};

struct MotionSpec {
  ActionPhase phase{};                   ///< part of the action
  bool is_of_platform{false};            ///< the platform moves, in place of the arm in use
  std::vector<Vector> goals;             ///< axes that move, alternatives [rad] ([m])
  MotionShape shape{MotionShape::free};  ///< between its ends
  /// Positions of the fingers of the hand in use to which they move in the last part of a straight
  /// motion of the tool [rad, m]; nullopt: they rest.
  std::optional<Vector> fingers;
  std::vector<std::string> allowed;    ///< what may be touched
  std::vector<std::string> tolerated;  ///< planned around; a foreseen touch does not hold the arm
  double speed{1.0};                   ///< scale of the velocity limits
  double max_length{1e9};              ///< of the path, sum of the max norms of its segments [rad]
  double timeout{std::numeric_limits<double>::infinity()};  ///< for the motion [s]

  std::optional<ObjectTarget> object;      ///< ends when this object is moved
  std::optional<ReceiverTarget> receiver;  ///< goals are handover configurations for this person
  /// Root of the robot's model in the world when the goals of a platform were chosen: the motion
  /// ends when the platform is found elsewhere by more than `max_displacement`.
  std::optional<Pose> T_world_root;
  std::string yields_to;        ///< ends when this person takes hold; empty: nobody
  std::string clears_area_for;  ///< ends when this person offers the object; empty: nobody
  bool accepts_any_offer{};     ///< such an offer counts however little space there is
};

/// What is held keeps an axis of the hand within an angle of up.
struct TiltBound {
  Vector3 axis_tool{Vector3::UnitZ()};  ///< unit, frame of the hand in use
  double max_tilt{};                    ///< [rad]
};

/// A path of the arm, or why there is none.
struct PlannedPath {
  Outcome outcome;                ///< whether there is a path
  std::vector<Vector> waypoints;  ///< axes of the arm [rad]
  std::string start_touches;      ///< id of what the robot touches at the start; empty: nothing
};

/// What the controller runs, and the path it came from.
struct RunningMotion {
  std::uint64_t command{};        ///< id of its command
  double duration{};              ///< of its trajectory [s]
  std::vector<Vector> waypoints;  ///< of its path, axes of the arm [rad]
  Vector speeds;                  ///< of its segments, as in TrajectoryReply
};

}  // namespace handsel::manipulation_planner
