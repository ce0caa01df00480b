// SPDX-License-Identifier: Apache-2.0
// Requests between the planners and their replies. A reply carries the id of its request; a
// repeated request is harmless.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/errors.hpp"
#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/messages/side.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

/// Identity of a request: unique over the system; the reply repeats it.
struct RequestId {
  std::uint64_t client{};  ///< random per process start
  std::uint64_t number{};  ///< grows with each request of the client
  bool operator==(const RequestId&) const = default;
};

/// An object rigidly held by a hand while the robot moves.
struct Attachment {
  std::string object;                    ///< scene object id; empty = nothing held
  Pose T_tool_object{Pose::Identity()};  ///< in the palm of that hand
  std::string hand{};                    ///< group of the hand that holds it; empty: "hand"
};

enum class PlannerKind : std::uint8_t { automatic, rrt, rrt_connect, trrt, bitrrt };

/// What is sampled: the axes of the group, or place of the tool and angle of the elbow (chapter
/// section 4.6.1).
enum class PlanSpace : std::uint8_t { joint, cartesian };

/// A goal pose of the group's tip, or the region around it.
struct TipGoal {
  Pose T_world_tip{Pose::Identity()};  ///< pose of the tip, the centre of the region
  Vector3 slack{Vector3::Zero()};      ///< half extents of a box along the pose's axes [m]
  double turn{};  ///< largest rotation about the pose's z axis, both directions [rad]
};

/// Topic PathRequest, profile request. Plans for one group of axes; the other axes stay as in
/// `start`. Beside the groups of the description there are "platform" (x, y [m], heading [rad] in
/// the world) and "robot" (the platform, then the arm).
struct PathRequest {
  Stamp stamp{};                      ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;                       ///< repeated by the reply
  std::string group;                  ///< "arm"
  PlanSpace space{PlanSpace::joint};  ///< what is sampled
  /// All axes of the robot [rad]; where the platform is planned for, its x, y [m], heading [rad]
  /// may follow; without them it starts from its current pose.
  Vector start;
  std::vector<Vector> goals;  ///< alternatives, group axes only [rad]; empty: `poses` are the goals
  std::vector<TipGoal> poses;  ///< alternatives, goal poses of the tip
  /// Cartesian space: robot axes that move along with the arm (hand, head).
  std::vector<std::uint32_t> also;
  Vector also_goal;  ///< goal of those axes [rad]
  bool upright{};    ///< `upright_axis` keeps a bounded angle to up everywhere on the path
  /// Unit vector, tool frame; received as +x where `upright` is false.
  Vector3 upright_axis{Vector3::UnitZ()};
  double max_tilt{};      ///< largest angle of that axis to up, [0, 3.1416] [rad]
  Attachment attachment;  ///< what the hand holds on the path
  /// Scene objects the hand may touch (the one to be grasped), and people whose hands and forearms
  /// are no obstacle because the exchange with them is engaged. The same meaning wherever this
  /// field appears.
  std::vector<std::string> allowed_contacts;
  PlannerKind planner{PlannerKind::automatic};  ///< algorithm; automatic: the planner chooses
  double time_limit{2.0};  ///< [s]; a budget of collision checks is derived from it
  std::uint64_t seed{};    ///< seed of the random choices
  /// Only the straight line from `start` to goals[0] is wanted, collision-checked.
  bool straight{};
  /// The running path, to be continued from `start`, a point on it that the arm has not reached
  /// yet. Empty: plan anew.
  std::vector<Vector> running;
  /// Stop the request of this id and all older ones of the client; their replies say so.
  bool cancel{};
};

/// How a path came about; all but the first belong to online replanning.
enum class PathOutcome : std::uint8_t {
  planned,    ///< the request had no running path
  kept,       ///< free, and nothing cheaper was found
  improved,   ///< free, and cheaper than before
  repaired,   ///< was blocked; led around what blocks it
  replanned,  ///< another goal, or nothing of it could be saved
  blocked,    ///< no path was found: the arm must stop
};

/// Topic PathReply, profile reply.
struct PathReply {
  Stamp stamp{};       ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;        ///< as in the request
  bool solved{};       ///< `path` leads from the start to a goal
  std::string reason;  ///< why not, one sentence
  /// Id of the object, box or person the robot touches at the start; empty: none.
  std::string start_touches;
  PathOutcome outcome{PathOutcome::planned};  ///< see PathOutcome
  std::uint32_t goal{};                       ///< index of the goal or pose reached
  std::vector<Vector> path;  ///< group axes, then those of `also`; path.front() = start
  /// Integral human-aware cost; mechanical work, the sum of its rises; joint-space length [rad].
  double cost{}, work{}, length{};
  std::uint64_t checks{};  ///< configurations checked for collision
};

/// A node of a motion of the tool (chapter section 4.6.1).
struct TipNode {
  Pose T_world_tip{Pose::Identity()};  ///< pose of the tip at the node
  bool has_elbow{};  ///< false: `elbow` is chosen such that the joints stay clear of their limits
  /// Angle on its circle about the line from shoulder to wrist, 0 = max position along axis 1
  /// [rad].
  double elbow{};
  Vector also;  ///< positions of the axes `also` of the request at the node [rad]
};

/// Topic TrajectoryRequest, profile request: from a polyline to jerk-limited motion, of joints or
/// of the tool.
struct TrajectoryRequest {
  Stamp stamp{};              ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;               ///< repeated by the reply
  std::string group;          ///< axes of the nodes, e.g. "arm"
  std::vector<Vector> nodes;  ///< group axes [rad]
  Vector start;               ///< all axes, for the collision checks of blends
  Attachment attachment;      ///< what the hand holds during the motion
  std::vector<std::string> allowed_contacts;  ///< as PathRequest::allowed_contacts
  double speed_scale{1.0};                    ///< factor on the comfort velocity limits, (0, 1]
  /// Nodes of the tool after `start`; empty: `nodes` are those of joints, and the fields below are
  /// unused.
  std::vector<TipNode> poses;
  std::vector<std::uint32_t> also;  ///< robot axes that are active besides the arm (hand, head)
  bool upright{};                   ///< as in PathRequest
  Vector3 upright_axis{Vector3::UnitZ()};  ///< unit, tool frame
  double max_tilt{};                       ///< largest angle of that axis to up, [0, 3.1416] [rad]
  /// Arm whose tip is rigidly joined to the group's (two hands on one object); empty: none.
  std::string follower{};
  Pose T_tip_follower{Pose::Identity()};  ///< tip of the follower in the frame of the group's tip
};

/// Topic TrajectoryReply, profile reply.
struct TrajectoryReply {
  Stamp stamp{};          ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;           ///< as in the request
  bool solved{};          ///< `trajectory` reaches the last node
  std::string reason;     ///< why not, one sentence
  Trajectory trajectory;  ///< motion of `axes`; an unsolved motion of the tool: as far as it goes
  double duration_ptp{};  ///< duration with a full stop at each node [s]
  Refusals corners;       ///< nodes that keep a full stop instead of a blend, and why
  std::vector<std::uint32_t> axes;  ///< robot axis of each trajectory axis
  std::uint32_t reached{};  ///< number of nodes the trajectory passes; all of them when solved
  /// Factor on the comfort velocity limits per path segment because of people; empty: 1.
  Vector speeds;
};

/// Contact of one finger with the object.
struct Contact {
  std::uint32_t finger{};             ///< index in the hand description; the thumb is 0
  Vector3 position{Vector3::Zero()};  ///< object frame [m]
  Vector3 normal{Vector3::UnitZ()};   ///< plane normal of its triangle, outward, object frame
  std::uint32_t triangle{};           ///< index in the mesh of the object
  /// Barycentric coordinates of the position in that triangle, sum 1
  Vector3 barycentric{Vector3::Zero()};
  double friction{};   ///< Coulomb coefficient
  double curvature{};  ///< interpolated mean curvature, normalised to [0, 1]
};

/// A grasp of a person's hand beside that of the robot's hand on the same object.
struct PartnerGrasp {
  std::uint64_t id{};      ///< unique per object and hand
  Side side{Side::right};  ///< whether the hand is a left or a right one
  /// Wrist of the person's hand in the object frame: z along the fingers, x out of the palm.
  Pose T_object_wrist{Pose::Identity()};
  double opposition{};  ///< angle between the directions of the two wrists [rad]
  double quality{};     ///< the smaller of the two grasps, [0, 1]
};

/// A grasp of one hand on one object (chapter section 3.2.1).
struct Grasp {
  std::uint64_t id{};                    ///< unique per object
  Pose T_object_hand{Pose::Identity()};  ///< hand frame = tool link of the robot
  Vector hand_joints;                    ///< actuated hand axes at contact [rad]
  Vector pregrasp_joints;                ///< opened before the approach [rad]
  /// Torque per actuated hand axis for a grip force inside the friction cones [Nm]; 0: the axis
  /// only holds.
  Vector hand_effort;
  std::vector<Contact> contacts;  ///< one per finger that touches the object
  double epsilon{};               ///< grasp quality of Ferrari and Canny, L1 norm
  /// Smallest force reserve inside the contacts' cones at that grip, over all load directions [N].
  double margin{};
  double quality{};        ///< weighted sum of the four parts, [0, 1]
  Vector arm_joints;       ///< arm axes reaching the grasp; empty until a robot was considered
  Vector approach_joints;  ///< arm axes at the stand-off before it
  bool has_platform{};     ///< the arm reaches it from `platform`, not from the current base pose
  /// Base pose x, y [m], heading [rad] in the world; no meaning unless `has_platform`.
  Vector3 platform{Vector3::Zero()};
  /// Fraction of the object that its receiver (else the robot's head) sees past the hand.
  double visible{};
  /// Hands of the person it is for that find room beside it: the right hands first, of each side
  /// the best first.
  std::vector<PartnerGrasp> partners;
};

/// Topic GraspRequest, profile request.
struct GraspRequest {
  Stamp stamp{};                 ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;                  ///< repeated by the reply
  std::string object;            ///< scene object id
  Vector start;                  ///< all axes of the robot; IK is seeded from it
  std::string for_human;         ///< id of the receiver, whose hand needs free space; empty: nobody
  std::uint32_t max_grasps{20};  ///< longest list wanted, 1 to 200
  std::uint64_t seed{};          ///< seed of the random choices
  std::string group;             ///< axes of the arm; empty: "arm"
  /// The object is to be put down again: the grasp must be reachable at `T_world_goal` too.
  bool has_goal{};
  Pose T_world_goal{Pose::Identity()};  ///< pose of the object at the end
  double min_visible{};                 ///< lower bound of Grasp::visible, [0, 1]
  bool move_platform{};  ///< platform poses are searched when no grasp is within reach
};

/// Topic GraspReply, profile reply: reachable, collision-free, best first.
struct GraspReply {
  Stamp stamp{};              ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;               ///< as in the request
  std::string reason;         ///< why the list is empty, one sentence
  std::vector<Grasp> grasps;  ///< best first
  Refusals rejected;          ///< counts per reason, e.g. {"113 frames", "thumb finds no contact"}
};

enum class RegraspKind : std::uint8_t {
  pick,   ///< from where it stands, by `to`
  pass,   ///< from `from` to `to`
  place,  ///< by `from`
  join,   ///< `to` takes hold besides `from`
};

/// Where an object may stand.
struct StandingPlace {
  Pose T_world_object{Pose::Identity()};  ///< pose of the object there
};

/// Topic RegraspRequest, profile request: hands to take an object with, one after the other or two
/// at once.
struct RegraspRequest {
  Stamp stamp{};       ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;        ///< repeated by the reply
  std::string object;  ///< scene object id
  Vector start;        ///< all axes of the robot
  std::string holder;  ///< group of the arm whose hand holds the object; empty: it stands
  /// Grasp of `holder`, as the object lies in the hand; no meaning while it is not held.
  Grasp grasp;
  /// Where the object may stand at the end, any of them, the best first; not empty, at most 64.
  std::vector<StandingPlace> goals;
  bool both{};  ///< two hands at once, which carry it there together; else from hand to hand
  /// Of both: the goals are poses in the air, reached straight after the lift; else the object is
  /// put down there.
  bool in_air{};
  std::uint64_t seed{};  ///< seed of the random choices
};

/// One change of hands. The whole robot's axes [rad].
struct RegraspStep {
  RegraspKind kind{};  ///< see RegraspKind
  /// Groups of the arms: the holding or releasing one, the taking one; empty: none.
  std::string from, to;
  Pose T_world_object{Pose::Identity()};  ///< the object meanwhile
  Grasp grasp;                            ///< grasp of `to`; of `from` where no arm takes
  Vector q;                               ///< all hands that touch the object closed on it
  Vector before;  ///< the hand that comes, opened, off the object; empty: none comes
  Vector after;   ///< the hand that went, opened, off the object; empty: none goes
};

/// Topic RegraspReply, profile reply.
struct RegraspReply {
  Stamp stamp{};                   ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;                    ///< as in the request
  bool solved{};                   ///< `steps` lead to the goal
  std::string reason;              ///< why not, one sentence
  std::vector<RegraspStep> steps;  ///< changes of hands in order, at most 32
  Refusals rejected;               ///< counts per reason
};

/// Topic GraspCandidates, profile advice, 2 Hz: better grasps for the task that runs.
struct GraspCandidates {
  Stamp stamp{};              ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::string object;         ///< scene object id; the key of the topic
  std::vector<Grasp> grasps;  ///< best first
};

/// Topic StateQuery, profile request, and StateVerdict, profile reply: may the robot be in these
/// configurations?
struct StateQuery {
  Stamp stamp{};               ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;                ///< repeated by the verdict
  std::vector<Vector> states;  ///< configurations, all axes each
  Attachment attachment;       ///< what the hand holds
  std::vector<std::string> allowed_contacts;  ///< as PathRequest::allowed_contacts
};

/// Reply to StateQuery.
struct StateVerdict {
  Stamp stamp{};                   ///< time of sending, UTC [ns]; 0: filled in by the bus
  RequestId id;                    ///< as in the query
  std::vector<std::uint8_t> free;  ///< 1 = free, one a state
  std::string reason;  ///< which bodies touch in the first configuration that is not free
  /// Smallest distance over all free configurations [m]; infinity: nothing near.
  double clearance{};
};

}  // namespace handsel
