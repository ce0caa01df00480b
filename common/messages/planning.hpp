// Requests between the planners and their replies. A reply carries the id of its request; asking twice is harmless.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/errors.hpp"
#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

/// Who asks: unique over the system; the reply repeats it.
struct RequestId {
  std::uint64_t client{};  ///< random per process start
  std::uint64_t number{};
  bool operator==(const RequestId&) const = default;
};

/// An object rigidly held by a hand while the robot moves.
struct Attachment {
  std::string object;                    ///< scene object id; empty = nothing held
  Pose T_tool_object{Pose::Identity()};  ///< in the palm of that hand
  std::string hand{};                    ///< group of the hand that holds it; empty: "hand"
};

enum class PlannerKind : std::uint8_t { automatic, rrt, rrt_connect, trrt, bitrrt };

/// What is sampled: the axes of the group, or place of the tool and angle of the elbow (chapter section 4.6.1).
enum class PlanSpace : std::uint8_t { joint, cartesian };

/// A place of the group's tip, or the region around it.
struct TipGoal {
  Pose T_world_tip{Pose::Identity()};
  Vector3 slack{Vector3::Zero()};  ///< half extents of a box along the pose's axes [m]
  double turn{};                   ///< about the pose's z axis either way [rad]
};

/// Topic PathRequest, profile request. Plans for one group of axes; the other axes stay as in `start`. Beside the groups of the
/// description there are "platform" (x, y [m], heading [rad] in the world) and "robot" (the platform, then the arm).
struct PathRequest {
  Stamp stamp{};
  RequestId id;
  std::string group;  ///< "arm"
  PlanSpace space{PlanSpace::joint};
  /// All axes of the robot [rad]; where the platform is planned for, its x, y, heading may follow: else it starts where it stands.
  Vector start;
  std::vector<Vector> goals;        ///< alternatives, group axes only [rad]; or
  std::vector<TipGoal> poses;       ///< alternatives, places of the tip
  std::vector<std::uint32_t> also;  ///< Cartesian: robot axes that move along with the arm (hand, head), and
  Vector also_goal;                 ///< where those end [rad]
  bool upright{};                   ///< `upright_axis` (tool frame) stays within `most_tilt` [rad] of up everywhere on the path
  Vector3 upright_axis{Vector3::UnitZ()};
  double most_tilt{};
  Attachment attachment;
  /// Scene objects the hand may touch (the one to be grasped), and people whose hands and forearms are no obstacle because
  /// the exchange with them is engaged. The same meaning wherever this field appears.
  std::vector<std::string> allowed_contacts;
  PlannerKind planner{PlannerKind::automatic};
  double time_limit{2.0};  ///< [s] a budget in checks is derived from it
  std::uint64_t seed{};
  bool straight{};  ///< only the straight line from start to goals[0] is wanted, checked
  /// The path that runs: it is gone on along from `start`, a place on it that the arm has not reached yet. Empty: plan from nothing.
  std::vector<Vector> running;
  bool cancel{};  ///< stop the request of this id and all older ones of the client; their replies say so
};

/// How a path came about; all but the first are of live requests.
enum class PathOutcome : std::uint8_t {
  planned,
  kept,       ///< free, and nothing cheaper was found
  improved,   ///< free, and cheaper than before
  repaired,   ///< was blocked; led around what blocks it
  replanned,  ///< another goal, or nothing of it could be saved
  blocked,    ///< no way was found: the arm must stop
};

/// Topic PathReply, profile reply.
struct PathReply {
  Stamp stamp{};
  RequestId id;
  bool solved{};
  std::string reason;         ///< why not, one sentence
  std::string start_touches;  ///< id of the object, box or person the robot touches at the start; empty: none
  PathOutcome outcome{PathOutcome::planned};
  std::uint32_t goal{};             ///< index of the goal or pose reached
  std::vector<Vector> path;         ///< group axes, then those of `also`; path.front() = start
  double cost{}, work{}, length{};  ///< integral human-aware cost, the sum of its rises; joint-space length [rad]
  std::uint64_t checks{};           ///< states judged
};

/// A node of a motion of the tool (chapter section 4.6.1).
struct TipNode {
  Pose T_world_tip{Pose::Identity()};
  bool has_elbow{};
  double elbow{};  ///< angle on its circle about the line from shoulder to wrist, 0 = farthest along axis 1 [rad]
  Vector also;     ///< where the further active axes are to be [rad]
};

/// Topic TrajectoryRequest, profile request: a broken line to soft motion, of joints or of the tool.
struct TrajectoryRequest {
  Stamp stamp{};
  RequestId id;
  std::string group;
  std::vector<Vector> nodes;  ///< group axes [rad]
  Vector start;               ///< all axes, for the collision checks of corners
  Attachment attachment;
  std::vector<std::string> allowed_contacts;
  double speed_scale{1.0};  ///< (0, 1] on the comfort velocity limits
  /// Nodes of the tool after `start`; empty: `nodes` are those of joints, and what follows is not used.
  std::vector<TipNode> poses;
  std::vector<std::uint32_t> also;  ///< robot axes that are active besides the arm (hand, head)
  bool upright{};                   ///< as in PathRequest
  Vector3 upright_axis{Vector3::UnitZ()};
  double most_tilt{};
  std::string follower{};  ///< arm whose tip is rigidly joined to the group's (two hands on one object); empty: none
  Pose T_tip_follower{Pose::Identity()};
};

/// Topic TrajectoryReply, profile reply.
struct TrajectoryReply {
  Stamp stamp{};
  RequestId id;
  bool solved{};
  std::string reason;
  Trajectory trajectory;            ///< of `axes`; of a motion of the tool that is not solved: as far as it goes
  double duration_ptp{};            ///< with a stop at each node [s]
  Refusals corners;                 ///< corners that keep their stop, and why
  std::vector<std::uint32_t> axes;  ///< robot axis of each trajectory axis
  std::uint32_t reached{};          ///< nodes on the way given; all of them when solved
  Vector speeds;                    ///< share of the comfort velocity limits on each leg, because of people; empty: 1 everywhere
};

struct Contact {
  std::uint32_t finger{};
  Vector3 position{Vector3::Zero()};  ///< object frame [m]
  Vector3 normal{Vector3::UnitZ()};   ///< plane normal of its triangle, outward, object frame
  std::uint32_t triangle{};
  Vector3 barycentric{Vector3::Zero()};
  double friction{};   ///< Coulomb coefficient
  double curvature{};  ///< interpolated mean curvature, normalised to [0, 1]
};

/// A grasp of one hand on one object (chapter section 3.2.1).
struct Grasp {
  std::uint64_t id{};
  Pose T_object_hand{Pose::Identity()};  ///< hand frame = tool link of the robot
  Vector hand_joints;                    ///< actuated hand axes at contact [rad]
  Vector pregrasp_joints;                ///< opened before the approach [rad]
  Vector hand_effort;                    ///< of the actuated hand axes that squeezes inside the friction cones [Nm]; 0: the axis only holds
  std::vector<Contact> contacts;
  double epsilon{};        ///< Ferrari-Canny, L1
  double margin{};         ///< least force left inside the contacts' cones under that squeeze, whichever way the load pulls [N]
  double quality{};        ///< weighted sum of the four parts, [0, 1]
  Vector arm_joints;       ///< arm axes reaching the grasp; empty until a robot was considered
  Vector approach_joints;  ///< arm axes at the stand-off before it
  bool has_platform{};     ///< the arm reaches it from `platform` (x, y [m], heading [rad], world), not from where it stands
  Vector3 platform{Vector3::Zero()};
  double visible{};  ///< share of the object that the person it is for (else the robot's head) sees past the hand
};

/// Topic GraspRequest, profile request.
struct GraspRequest {
  Stamp stamp{};
  RequestId id;
  std::string object;     ///< scene object id
  Vector start;           ///< all axes of the robot; IK is seeded from it
  std::string for_human;  ///< person who will take it, or empty: leave room for that hand
  std::uint32_t max_grasps{20};
  std::uint64_t seed{};
  std::string group;                    ///< axes of the arm; empty: "arm"
  bool has_goal{};                      ///< it is to be put down again: the grasp must serve at `T_world_goal` too
  Pose T_world_goal{Pose::Identity()};  ///< the object where it will stand
  double least_visible{};               ///< of Grasp::visible, [0, 1]
  bool move_platform{};                 ///< where no grasp is in reach, places of the platform are searched
};

/// Topic GraspReply, profile reply: reachable, collision-free, best first.
struct GraspReply {
  Stamp stamp{};
  RequestId id;
  std::string reason;  ///< set when the list is empty
  std::vector<Grasp> grasps;
  Refusals rejected;  ///< counts per reason, e.g. {"113 frames", "thumb finds no contact"}
};

enum class RegraspKind : std::uint8_t {
  pick,   ///< from where it stands, by `to`
  pass,   ///< from `from` to `to`
  place,  ///< by `from`
  join,   ///< `to` takes hold besides `from`
};

/// Topic RegraspRequest, profile request: hands to take an object with, one after the other or two at once.
struct RegraspRequest {
  Stamp stamp{};
  RequestId id;
  std::string object;  ///< scene object id
  Vector start;        ///< all axes of the robot
  Pose T_world_goal{Pose::Identity()};
  bool both{};  ///< two hands at once, which carry it there together; else from hand to hand
  std::uint64_t seed{};
};

/// One change of hands. The whole robot's axes [rad].
struct RegraspStep {
  RegraspKind kind{};
  std::string from, to;                   ///< groups of the arms: who has it or lets go, who takes; empty: none
  Pose T_world_object{Pose::Identity()};  ///< the object meanwhile
  Grasp grasp;                            ///< of `to`; of `from` where nobody takes
  Vector q;                               ///< all hands that touch the object closed on it
  Vector before;                          ///< the hand that comes, opened, off the object; empty: none comes
  Vector after;                           ///< the hand that went, opened, off the object; empty: none goes
};

/// Topic RegraspReply, profile reply.
struct RegraspReply {
  Stamp stamp{};
  RequestId id;
  bool solved{};
  std::string reason;
  std::vector<RegraspStep> steps;
  Refusals rejected;
};

/// Topic GraspCandidates, profile advice, 2 Hz: better grasps for the task that runs.
struct GraspCandidates {
  Stamp stamp{};
  std::string object;
  std::vector<Grasp> grasps;
};

/// Topic StateQuery, profile request, and StateVerdict, profile reply: may the robot be in these configurations?
struct StateQuery {
  Stamp stamp{};
  RequestId id;
  std::vector<Vector> states;  ///< all axes
  Attachment attachment;
  std::vector<std::string> allowed_contacts;
};

struct StateVerdict {
  Stamp stamp{};
  RequestId id;
  std::vector<std::uint8_t> free;  ///< 1 = free, one a state
  std::string reason;              ///< what touches what in the first that is not
  double clearance{};              ///< least distance of all the free states [m]
};

}  // namespace handsel
