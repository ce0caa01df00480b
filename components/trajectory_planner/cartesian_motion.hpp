// SPDX-License-Identifier: Apache-2.0
// Plans a jerk-limited trajectory of a redundant arm from waypoints in Cartesian space (chapter
// section 4.6). Active axes: position and rotation vector of the tool, the angle of the elbow, hand
// and head; they have the smoothed trajectory TR. Passive axes: the joints of the arm, by inverse
// kinematics at the period of the controller, approximated by TR_app and slowed down where they
// exceed their limits. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/path/approximate.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "components/trajectory_planner/closed_chain.hpp"
#include "components/trajectory_planner/speed_along.hpp"

namespace handsel::trajectory_planner {

struct CartesianWaypoint {
  /// Goal pose of the tip of the arm, frame of the root link.
  Pose T_root_tool{Pose::Identity()};
  /// Elbow angle on the circle about the line from shoulder to wrist, 0 = max along axis 1 [rad];
  /// nullopt: selected for distance of the joints from their limits.
  std::optional<double> elbow{};
  Vector also{};  ///< positions of the further active axes [rad]
};

/// Bound on the tilt of the held object on the whole path.
struct HeldLevel {
  Vector3 axis_tool{Vector3::UnitZ()};  ///< axis of the tool that is along up_root when upright
  Vector3 up_root{Vector3::UnitZ()};    ///< up in the frame of the root link
  double bound{0.1};                    ///< max angle between the two [rad]
};

struct CartesianRequest {
  Vector start;  ///< all axes of the robot [rad]; pose of the first waypoint
  /// Further active robot axes: hand, head; for a robot on its platform (common/model/platform.hpp)
  /// also x, y and heading.
  std::vector<int> also;
  std::vector<CartesianWaypoint> nodes;  ///< waypoints after the start
  std::optional<HeldLevel> level{};      ///< bound on the tilt; nullopt: none
  /// Second arm that follows; the motion then stops at every waypoint.
  std::optional<JoinedArm> joined{};
  double speed_scale{1};  ///< factor of all velocity limits, (0, 1]
  /// Reduces the velocity limits of the active axes along the path; null: no people.
  const SpeedAlong* people{};
};

struct RateBounds {
  /// Upper bounds of one coordinate, > 0; unit as documented at the use.
  double velocity{}, acceleration{}, jerk{};
};

struct CartesianSettings {
  /// Bounds of each coordinate of the tool's position [m/s, m/s^2, m/s^3].
  RateBounds translation{0.25, 0.6, 2.0};
  /// Bounds of each coordinate of the rotation vector; their norm bounds the rotation [rad/s, ...].
  RateBounds rotation{0.6, 1.5, 5.0};
  RateBounds elbow{0.6, 1.5, 5.0};  ///< bounds of the elbow angle [rad/s, ...]
  double allowed_excess{0.1};       ///< allowed excess of three segments at blends
  double period{0.002};             ///< period of the computed joints [s]
  /// Max motion of a joint in one period; a larger one is a change of branch and refused [rad].
  double largest_step{0.1};
  double collision_step{0.01};  ///< step of the collision checks [rad, max norm]
  int elbows{24};               ///< elbow angles tried at a waypoint without elbow angle
  ApproximationTolerance tolerance{2e-4, 1e-2};  ///< of TR_app to the sampled joints [rad], [rad/s]
  JoinError max_apart{1e-3, 3.5e-3};  ///< max error of the joined tips; a larger one is refused
  /// Weight of elbow motion against joints near their limits in the choice of elbow angles [1/rad].
  double elbow_weight{0.3};
};

/// TR: the smoothed trajectory of the active axes, and its poses. Own method: the rotation vector
/// is accumulated over segments. On a segment it is the rotation between the waypoints about one
/// axis; in a blend it refers to the waypoint of the blend.
class CartesianTrajectory {
 public:
  struct Node {
    Pose T_root_tool{Pose::Identity()};  ///< pose of the tool at the node, frame of the root link
    Vector active;  ///< position [m], rotation vector, elbow, further axes [rad]
  };

  /// Returns the time from the first node to the last [s].
  double duration() const { return active_.duration(); }
  /// Returns the trajectory of the active axes: position [m], rotation vector, elbow, further
  /// axes [rad].
  const Trajectory& active() const { return active_; }
  /// Returns the waypoints of the motion, the start first.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// Returns the pose of the tool at time t [s], frame of the root link.
  Pose pose(double t) const;
  /// Returns the angle [rad] of the elbow on its circle at time t [s].
  double elbow(double t) const { return active_.at(t).position[6]; }
  /// Returns the pose for active values near a waypoint, frame of the root link.
  Pose pose_at(const Vector& active, std::size_t node) const;
  /// Returns the waypoint whose blend or adjacent halves of segments contain the time t [s].
  std::size_t node_at(double t) const;

 private:
  friend class CartesianPlanning;
  std::vector<Node> nodes_;
  Trajectory active_;
  std::vector<double> middles_;  // time at the middle of each segment [s]
};

struct CartesianMotion {
  bool solved{};       ///< whether every waypoint of the request is reached
  std::string reason;  ///< why the motion is incomplete, one sentence
  /// Number of reached waypoints of the request; all of them if solved. Excludes colliding
  /// waypoints.
  std::size_t reached{};
  CartesianTrajectory path;          ///< TR, up to the last reached waypoint
  double duration_ptp{};             ///< duration with a stop at each waypoint [s]
  std::vector<BlendReport> corners;  ///< blends at the waypoints of `path`
  /// Number in the request of each waypoint of `path`; the start is 0.
  std::vector<std::size_t> given;
  /// Speed limits of each segment of `path` because of people; empty: no people.
  std::vector<LimitZones> speeds;
  double cost{};  ///< max human-aware cost on the path, [0, 1]
  /// Robot axes of `samples` and `executable`: arm, further axes, joined arm.
  std::vector<int> axes;
  JoinError joined{};           ///< max error on the path, of TR_app
  std::vector<Vector> samples;  ///< positions at each period of `path`
  Executable executable;        ///< TR_app, within the comfort limits of the robot
};

/// Plans a Cartesian motion. Skips waypoints equal to the previous one. If there is no path to a
/// waypoint (out of reach, rotation by pi, joint limit, change of branch, collision, tilt of the
/// held object), the motion ends at the previous waypoint with a reason. The arm must consist of
/// shoulder, elbow and wrist (ik::SrsArm).
CartesianMotion plan_cartesian(const RobotModel& robot, const Group& arm, CollisionWorld& world,
                               const CartesianRequest& request,
                               const CartesianSettings& settings = {});

}  // namespace handsel::trajectory_planner
