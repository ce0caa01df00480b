// SPDX-License-Identifier: Apache-2.0
#include "common/messages/planning.hpp"
#include "common/messages/names.hpp"

#include "common/wire/parts.hpp"

namespace handsel {
namespace {
constexpr const char* kPlanners[] = {"automatic", "rrt", "rrt_connect", "trrt", "bitrrt"};
constexpr const char* kSpaces[] = {"joint", "cartesian"};
constexpr const char* kOutcomes[] = {"planned",  "kept",      "improved",
                                     "repaired", "replanned", "blocked"};
constexpr Range kTurn{0, 3.1416};  // [rad]
}  // namespace

void describe(WireIo& io, Contact& m, handsel_Contact& w) {
  io.integer("finger", m.finger, w.finger);
  io.point("position", m.position, w.position);
  io.direction("normal", m.normal, w.normal);
  io.integer("triangle", m.triangle, w.triangle);
  io.point("barycentric", m.barycentric, w.barycentric, {-1, 2});
  io.number("friction", m.friction, w.friction, {0, 10});
  io.number("curvature", m.curvature, w.curvature, kFraction);
}

void describe(WireIo& io, PartnerGrasp& m, handsel_PartnerGrasp& w) {
  io.integer("id", m.id, w.id);
  io.choice("side", m.side, w.side, kSideNames);
  io.pose("T_object_wrist", m.T_object_wrist, w.T_object_wrist);
  io.number("opposition", m.opposition, w.opposition, {0, 3.1416});
  io.number("quality", m.quality, w.quality, {-1e3, 1e3});
}

void describe(WireIo& io, Grasp& m, handsel_Grasp& w) {
  io.integer("id", m.id, w.id);
  io.pose("T_object_hand", m.T_object_hand, w.T_object_hand);
  io.vector("hand_joints", m.hand_joints, w.hand_joints, kCoordinate);
  io.vector("pregrasp_joints", m.pregrasp_joints, w.pregrasp_joints, kCoordinate);
  io.vector("hand_effort", m.hand_effort, w.hand_effort, kCoordinate);
  io.list("contacts", m.contacts, w.contacts, 16);
  io.number("epsilon", m.epsilon, w.epsilon, {-1e3, 1e3});
  io.number("margin", m.margin, w.margin, {-1e3, 1e3});
  io.number("quality", m.quality, w.quality, {-1e3, 1e3});
  io.vector("arm_joints", m.arm_joints, w.arm_joints, kCoordinate);
  io.vector("approach_joints", m.approach_joints, w.approach_joints, kCoordinate);
  io.flag("has_platform", m.has_platform, w.has_platform);
  io.point("platform", m.platform, w.platform);
  io.number("visible", m.visible, w.visible, {0, 1});
  io.list("partners", m.partners, w.partners, 8, true);
  io.check(m.hand_joints.size() == m.pregrasp_joints.size() || m.pregrasp_joints.size() == 0,
           "pregrasp_joints", "has not as many values as hand_joints");
  io.check(m.hand_effort.size() == m.hand_joints.size() || m.hand_effort.size() == 0, "hand_effort",
           "has not as many values as hand_joints");
}

void describe(WireIo& io, TipGoal& m, handsel_TipGoal& w) {
  io.pose("T_world_tip", m.T_world_tip, w.T_world_tip);
  io.point("slack", m.slack, w.slack, {0, 1e4});
  io.number("turn", m.turn, w.turn, kTurn);
}

void describe(WireIo& io, PathRequest& m, handsel_PathRequest& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.text("group", m.group, w.group, Text::name);
  io.choice("space", m.space, w.space, kSpaces);
  io.vector("start", m.start, w.start, kCoordinate);
  io.list("goals", m.goals, w.goals, 64,
          true);  // alternatives: the first ones suffice
  io.list("poses", m.poses, w.poses, 64, true);
  io.indices("also", m.also, w.also, kMaxAxes, kMaxAxes - 1);
  io.vector("also_goal", m.also_goal, w.also_goal, kCoordinate);
  io.flag("upright", m.upright, w.upright);
  io.direction("upright_axis", m.upright_axis, w.upright_axis, m.upright);
  io.number("max_tilt", m.max_tilt, w.max_tilt, kTurn);
  io.part("attachment", m.attachment, w.attachment);
  describe_contacts(io, m.allowed_contacts, w.allowed_contacts);
  io.choice("planner", m.planner, w.planner, kPlanners);
  io.number("time_limit", m.time_limit, w.time_limit, kPeriod);
  io.integer("seed", m.seed, w.seed);
  io.flag("straight", m.straight, w.straight);
  io.list("running", m.running, w.running, 4096);
  io.flag("cancel", m.cancel, w.cancel);
  io.check(static_cast<std::size_t>(m.also_goal.size()) == m.also.size(), "also_goal",
           "has not as many values as also");
  io.check(m.cancel || m.start.size() > 0, "start",
           "is empty, one value per axis of the robot is needed");
  io.check(equally_wide(m.goals), "goals", "have different numbers of axes");
  io.check(equally_wide(m.running), "running", "has points with different numbers of axes");
}

void describe(WireIo& io, PathReply& m, handsel_PathReply& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.flag("solved", m.solved, w.solved);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.text("start_touches", m.start_touches, w.start_touches, Text::maybe_empty);
  io.choice("outcome", m.outcome, w.outcome, kOutcomes);
  io.integer("goal", m.goal, w.goal, 0, 63);
  io.list("path", m.path, w.path, 4096);
  io.number("cost", m.cost, w.cost, {0, 1e9});
  io.number("work", m.work, w.work, {0, 1e9});
  io.number("length", m.length, w.length, {0, 1e9});
  io.integer("checks", m.checks, w.checks);
  io.check(equally_wide(m.path), "path", "has points with different numbers of axes");
}

void describe(WireIo& io, TipNode& m, handsel_TipNode& w) {
  io.pose("T_world_tip", m.T_world_tip, w.T_world_tip);
  io.flag("has_elbow", m.has_elbow, w.has_elbow);
  io.number("elbow", m.elbow, w.elbow, kCoordinate);
  io.vector("also", m.also, w.also, kCoordinate);
}

void describe(WireIo& io, TrajectoryRequest& m, handsel_TrajectoryRequest& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.text("group", m.group, w.group, Text::name);
  io.list("nodes", m.nodes, w.nodes, 4096);
  io.vector("start", m.start, w.start, kCoordinate);
  io.part("attachment", m.attachment, w.attachment);
  describe_contacts(io, m.allowed_contacts, w.allowed_contacts);
  io.number("speed_scale", m.speed_scale, w.speed_scale, {0, 1, true});
  io.list("poses", m.poses, w.poses, 256);
  io.indices("also", m.also, w.also, kMaxAxes, kMaxAxes - 1);
  io.flag("upright", m.upright, w.upright);
  io.direction("upright_axis", m.upright_axis, w.upright_axis, m.upright);
  io.number("max_tilt", m.max_tilt, w.max_tilt, kTurn);
  io.text("follower", m.follower, w.follower, Text::maybe_empty);
  io.pose("T_tip_follower", m.T_tip_follower, w.T_tip_follower);
  io.check(equally_wide(m.nodes), "nodes", "have different numbers of axes");
}

void describe(WireIo& io, TrajectoryReply& m, handsel_TrajectoryReply& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.flag("solved", m.solved, w.solved);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.part("trajectory", m.trajectory, w.trajectory);
  io.number("duration_ptp", m.duration_ptp, w.duration_ptp, kTime);
  io.list("corners", m.corners, w.corners, 256, true);
  io.indices("axes", m.axes, w.axes, kMaxAxes, kMaxAxes - 1);
  io.integer("reached", m.reached, w.reached, 0, 4096);
  io.vector("speeds", m.speeds, w.speeds, {0, 1});
}

void describe(WireIo& io, GraspRequest& m, handsel_GraspRequest& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.text("object", m.object, w.object, Text::name);
  io.vector("start", m.start, w.start, kCoordinate);
  io.text("for_human", m.for_human, w.for_human, Text::maybe_empty);
  io.integer("max_grasps", m.max_grasps, w.max_grasps, 1, 200);
  io.integer("seed", m.seed, w.seed);
  io.text("group", m.group, w.group, Text::maybe_empty);
  io.flag("has_goal", m.has_goal, w.has_goal);
  io.pose("T_world_goal", m.T_world_goal, w.T_world_goal);
  io.number("min_visible", m.min_visible, w.min_visible, {0, 1});
  io.flag("move_platform", m.move_platform, w.move_platform);
}

void describe(WireIo& io, GraspReply& m, handsel_GraspReply& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.list("grasps", m.grasps, w.grasps, 200, true);
  io.list("rejected", m.rejected, w.rejected, 256, true);
}

void describe(WireIo& io, StandingPlace& m, handsel_StandingPlace& w) {
  io.pose("T_world_object", m.T_world_object, w.T_world_object);
}

void describe(WireIo& io, RegraspRequest& m, handsel_RegraspRequest& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.text("object", m.object, w.object, Text::name);
  io.vector("start", m.start, w.start, kCoordinate);
  io.text("holder", m.holder, w.holder, Text::maybe_empty);
  io.part("grasp", m.grasp, w.grasp);
  io.list("goals", m.goals, w.goals, 64);
  io.flag("both", m.both, w.both);
  io.flag("in_air", m.in_air, w.in_air);
  io.integer("seed", m.seed, w.seed);
  io.check(m.start.size() > 0, "start", "is empty, one value per axis of the robot is needed");
  io.check(!m.goals.empty(), "goals", "is empty, at least one place is needed");
  io.check(m.both || !m.in_air, "in_air", "is for two hands at once, but both is false");
}

void describe(WireIo& io, RegraspStep& m, handsel_RegraspStep& w) {
  io.choice("kind", m.kind, w.kind, kRegraspKindNames);
  io.text("from", m.from, w.from, Text::maybe_empty);
  io.text("to", m.to, w.to, Text::maybe_empty);
  io.pose("T_world_object", m.T_world_object, w.T_world_object);
  io.part("grasp", m.grasp, w.grasp);
  io.vector("q", m.q, w.q, kCoordinate);
  io.vector("before", m.before, w.before, kCoordinate);
  io.vector("after", m.after, w.after, kCoordinate);
}

void describe(WireIo& io, RegraspReply& m, handsel_RegraspReply& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.flag("solved", m.solved, w.solved);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.list("steps", m.steps, w.steps, 32);
  io.list("rejected", m.rejected, w.rejected, 256, true);
}

void describe(WireIo& io, GraspCandidates& m, handsel_GraspCandidates& w) {
  io.text("object", m.object, w.object, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.list("grasps", m.grasps, w.grasps, 200, true);
}

void describe(WireIo& io, StateQuery& m, handsel_StateQuery& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.list("states", m.states, w.states, 4096);
  io.part("attachment", m.attachment, w.attachment);
  describe_contacts(io, m.allowed_contacts, w.allowed_contacts);
  io.check(equally_wide(m.states), "states", "have different numbers of axes");
}

void describe(WireIo& io, StateVerdict& m, handsel_StateVerdict& w) {
  io.stamp(m.stamp, w.stamp);
  io.part("id", m.id, w.id);
  io.bytes("free", m.free, w.free, 4096, 1);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.horizon("clearance", m.clearance, w.clearance, -1e4);
}

HANDSEL_WIRE(PathRequest)
HANDSEL_WIRE(PathReply)
HANDSEL_WIRE(TrajectoryRequest)
HANDSEL_WIRE(TrajectoryReply)
HANDSEL_WIRE(GraspRequest)
HANDSEL_WIRE(GraspReply)
HANDSEL_WIRE(RegraspRequest)
HANDSEL_WIRE(RegraspReply)
HANDSEL_WIRE_KEYED(GraspCandidates, object)
HANDSEL_WIRE(StateQuery)
HANDSEL_WIRE(StateVerdict)

}  // namespace handsel
