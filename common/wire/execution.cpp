// SPDX-License-Identifier: Apache-2.0
#include "common/messages/execution.hpp"
#include "common/messages/names.hpp"

#include "common/wire/parts.hpp"
#include "idl/execution.h"

namespace handsel {
namespace {

constexpr const char* kHandActions[] = {"move", "grasp", "release_on_pull", "release"};
constexpr const char* kMotions[] = {"idle", "running", "finished", "refused", "stopped"};
constexpr Range kLimitRatio{0, 1e9};
static_assert(handsel_CAUSE_SEPARATION == static_cast<int>(Cause::separation) &&
                  handsel_CAUSE_COST_AHEAD == static_cast<int>(Cause::cost_ahead),
              "the bits of ExecutionStatus.causes are the enumerators of Cause in IDL and domain");

}  // namespace

void describe(WireIo& io, Go& m, handsel_Go& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("epoch", m.epoch, w.epoch);
  io.flag("allowed", m.allowed, w.allowed);
  io.flag("acknowledge", m.acknowledge, w.acknowledge);
  io.number("override_factor", m.override_factor, w.override_factor, kFraction);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.integer("state_revision", m.state_revision, w.state_revision);
}

void describe(WireIo& io, TrajectoryCommand& m, handsel_TrajectoryCommand& w) {
  io.text("robot", m.robot, w.robot, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.integer("id", m.id, w.id);
  io.integer("epoch", m.epoch, w.epoch);
  io.indices("axes", m.axes, w.axes, kMaxAxes, kMaxAxes - 1);
  io.part("trajectory", m.trajectory, w.trajectory);
  io.number("switch_at", m.switch_at, w.switch_at, {0, 1e6});
  io.part("attachment", m.attachment, w.attachment);
  describe_contacts(io, m.allowed_contacts, w.allowed_contacts);
  io.check(m.axes.size() == m.trajectory.axes.size(), "axes", "are not as many as trajectory.axes");
}

void describe(WireIo& io, HandCommand& m, handsel_HandCommand& w) {
  io.text("robot", m.robot, w.robot, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.integer("id", m.id, w.id);
  io.integer("epoch", m.epoch, w.epoch);
  io.choice("action", m.action, w.action, kHandActions);
  io.text("group", m.group, w.group, Text::maybe_empty);
  io.vector("position", m.position, w.position, kCoordinate);
  io.vector("effort", m.effort, w.effort, kCoordinate);
  io.number("pull_force", m.pull_force, w.pull_force, {0, 1e5});
  io.number("payload", m.payload, w.payload, {0, 1e3});
  io.flag("both_hands", m.both_hands, w.both_hands);
}

void describe(WireIo& io, OtherHandState& m, handsel_OtherHandState& w) {
  io.text("group", m.group, w.group, Text::name);
  io.choice("hand", m.hand, w.hand, kHandStateNames);
}

void describe(WireIo& io, ExecutionStatus& m, handsel_ExecutionStatus& w) {
  io.text("robot", m.robot, w.robot, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.choice("mode", m.mode, w.mode, kModeNames);
  io.integer("causes", m.causes, w.causes);
  io.integer("epoch", m.epoch, w.epoch);
  io.integer("trajectory", m.trajectory, w.trajectory);
  io.choice("motion", m.motion, w.motion, kMotions);
  io.number("progress", m.progress, w.progress, kFraction);
  io.integer("hand_command", m.hand_command, w.hand_command);
  io.choice("hand", m.hand, w.hand, kHandStateNames);
  io.list("other_hands", m.other_hands, w.other_hands, 3);
  io.number("pull", m.pull, w.pull, kForce);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.integer("cycles", m.cycles, w.cycles);
  io.integer("late_cycles", m.late_cycles, w.late_cycles);
  io.number("limit_ratio_velocity", m.limit_ratio_velocity, w.limit_ratio_velocity, kLimitRatio);
  io.number("limit_ratio_acceleration", m.limit_ratio_acceleration, w.limit_ratio_acceleration,
            kLimitRatio);
  io.number("limit_ratio_jerk", m.limit_ratio_jerk, w.limit_ratio_jerk, kLimitRatio);
  io.horizon("separation", m.separation, w.separation, -1e4);
  io.number("separation_limit", m.separation_limit, w.separation_limit, {0, 1e4});
  io.point("nearest_on_robot", m.nearest_on_robot, w.nearest_on_robot);
  io.point("nearest_on_person", m.nearest_on_person, w.nearest_on_person);
}

void describe(WireIo& io, ActiveTrajectory& m, handsel_ActiveTrajectory& w) {
  io.text("robot", m.robot, w.robot, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.pose("T_world_base", m.T_world_base, w.T_world_base);
  io.integer("trajectory", m.trajectory, w.trajectory);
  io.number("time", m.time, w.time, {0, 1e6});
  io.number("speed_factor", m.speed_factor, w.speed_factor, kSigned);
  io.vector("position", m.position, w.position, kCoordinate);
  io.vector("velocity", m.velocity, w.velocity, kCoordinate);
  io.vector("acceleration", m.acceleration, w.acceleration, kAcceleration);
  io.indices("axes", m.axes, w.axes, kMaxAxes, kMaxAxes - 1);
  io.part("rest", m.rest, w.rest);
  io.part("attachment", m.attachment, w.attachment);
  describe_contacts(io, m.allowed_contacts, w.allowed_contacts);
  io.check(m.velocity.size() == m.position.size(), "velocity",
           "has not as many values as position");
  io.check(m.acceleration.size() == m.position.size(), "acceleration",
           "has not as many values as position");
  io.check(m.axes.size() == m.rest.axes.size(), "axes", "are not as many as rest.axes");
}

void describe(WireIo& io, TrajectoryForecast& m, handsel_TrajectoryForecast& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("trajectory", m.trajectory, w.trajectory);
  io.flag("collides", m.collides, w.collides);
  io.horizon("time_to_collision", m.time_to_collision, w.time_to_collision, 0);
  io.horizon("clearance", m.clearance, w.clearance, -1e4);
  io.number("cost", m.cost, w.cost, kFraction);
  io.text("reason", m.reason, w.reason, Text::sentence);
}

HANDSEL_WIRE(Go)
HANDSEL_WIRE_KEYED(TrajectoryCommand, robot)
HANDSEL_WIRE_KEYED(HandCommand, robot)
HANDSEL_WIRE_KEYED(ExecutionStatus, robot)
HANDSEL_WIRE_KEYED(ActiveTrajectory, robot)
HANDSEL_WIRE(TrajectoryForecast)

}  // namespace handsel
