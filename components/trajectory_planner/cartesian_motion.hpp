// From nodes in the Cartesian space of a redundant arm to soft motion of its joints (chapter
// section 4.6). Active axes: position and rotation vector of the tool, the angle of the elbow, hand
// and head; they get the smoothed trajectory TR. Passive: the joints of the arm, by inverse
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
  /// Wanted pose of the tip of the arm, frame of the root link.
  Pose T_root_tool{Pose::Identity()};
  /// Angle on its circle about the line from shoulder to wrist, 0 = farthest along axis 1 [rad];
  /// left out: chosen so that the joints keep clearance to their limits.
  std::optional<double> elbow{};
  Vector also{};  ///< positions of the further active axes [rad]
};

/// What is held stays upright on the whole path.
struct HeldLevel {
  Vector3 axis_tool{Vector3::UnitZ()};  ///< of the tool, along up_root when upright
  Vector3 up_root{Vector3::UnitZ()};    ///< up in the frame of the root link
  double bound{0.1};                    ///< largest angle between the two [rad]
};

struct CartesianRequest {
  Vector start;  ///< all axes of the robot [rad]; the first node is where it is
  /// Robot axes that are active besides the arm: hand, head; of a robot on its platform
  /// (common/model/platform.hpp) x, y, heading too.
  std::vector<int> also;
  std::vector<CartesianWaypoint> nodes;  ///< after the start
  std::optional<HeldLevel> level{};      ///< what is held is to stay upright; empty: nothing is
  std::optional<JoinedArm> joined{};     ///< follows; every node is then a stop
  double speed_scale{1};                 ///< (0, 1] on all velocity limits
  /// Lowers those of the active axes along the path; null: no people.
  const SpeedAlong* people{};
};

struct RateBounds {
  /// Upper bounds of one coordinate, > 0; units as at the use.
  double velocity{}, acceleration{}, jerk{};
};

struct CartesianSettings {
  /// Of each coordinate of the tool's position [m/s, m/s^2, m/s^3].
  RateBounds translation{0.25, 0.6, 2.0};
  /// Of each coordinate of its rotation vector; no turn is faster than their norm [rad/s, ...].
  RateBounds rotation{0.6, 1.5, 5.0};
  RateBounds elbow{0.6, 1.5, 5.0};  ///< [rad/s, ...]
  double allowed_excess{0.1};       ///< of three segments at corners
  double period{0.002};             ///< the joints are computed this often [s]
  /// A joint that moves farther in a period has changed branch: refused [rad].
  double largest_step{0.1};
  double collision_step{0.01};  ///< configurations are checked this often [rad, max norm]
  int elbows{24};               ///< angles tried at a node that leaves its elbow open
  ApproximationTolerance tolerance{2e-4, 1e-2};  ///< of TR_app to the sampled joints [rad], [rad/s]
  JoinError max_apart{1e-3, 3.5e-3};  ///< of joined tips: beyond it the motion is refused
};

/// TR: the smoothed trajectory of the active axes and how to read poses from it. Own method: the
/// rotation vector is counted on from segment to segment. On a segment it is the displacement from
/// node to node, one axis and an angle; in a blend it is taken at the node of the blend.
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
  /// Returns the nodes the motion leads by, the start first.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// Returns the pose of the tool at time t [s], frame of the root link.
  Pose pose(double t) const;
  /// Returns the angle [rad] of the elbow on its circle at time t [s].
  double elbow(double t) const { return active_.at(t).position[6]; }
  /// Returns the pose for active values near a node, frame of the root link.
  Pose pose_at(const Vector& active, std::size_t node) const;
  /// Returns the index of the node whose blend or adjacent halves of segments are run at t [s].
  std::size_t node_at(double t) const;

 private:
  friend class CartesianPlanning;
  std::vector<Node> nodes_;
  Trajectory active_;
  std::vector<double> middles_;  // when the middle of each segment is passed [s]
};

struct CartesianMotion {
  bool solved{};       ///< every node of the request is reached
  std::string reason;  ///< why not, one sentence
  /// Nodes of the request on the path that follows; all of them when solved. Never a node that
  /// collides.
  std::size_t reached{};
  CartesianTrajectory path;          ///< TR, as far as the motion goes
  double duration_ptp{};             ///< with a stop at each node [s]
  std::vector<BlendReport> corners;  ///< of nodes of `path`
  /// Of each node of `path` the number in the request; the start is 0.
  std::vector<std::size_t> given;
  /// Of each segment of `path`, because of people; empty: no people.
  std::vector<LimitZones> speeds;
  double cost{};  ///< largest human-aware cost on the path, [0, 1]
  /// Robot axes of what follows: those of the arm, the further ones, then those of the joined arm.
  std::vector<int> axes;
  JoinError joined{};           ///< largest on the path, of TR_app
  std::vector<Vector> samples;  ///< positions at each period of `path`
  Executable executable;        ///< TR_app, inside the comfort limits of the robot
};

/// Nodes equal to the one before are left out. Where the path to a node does not exist (out of
/// reach, a turn by pi, a joint limit or another branch between, a collision, what is held leans
/// over), the motion ends at the node before it, and the reason says what is wrong. The arm must be
/// one of shoulder, elbow and wrist (ik::SrsArm).
CartesianMotion plan_cartesian(const RobotModel& robot, const Group& arm, CollisionWorld& world,
                               const CartesianRequest& request,
                               const CartesianSettings& settings = {});

}  // namespace handsel::trajectory_planner
