// SPDX-License-Identifier: Apache-2.0
#include "common/messages/system.hpp"
#include "common/messages/names.hpp"

#include "common/wire/parts.hpp"
#include "idl/system.h"

namespace handsel {
namespace {
constexpr Range kReportedLimitRatio{0, 1e9};
}  // namespace

void describe(WireIo& io, TopicHealth& m, handsel_TopicHealth& w) {
  io.text("topic", m.topic, w.topic, Text::name);
  io.integer("received", m.received, w.received);
  io.number("rate", m.rate, w.rate, {0, 1e6});
  io.number("age", m.age, w.age, {-1, 1e9});
  io.integer("deadline_misses", m.deadline_misses, w.deadline_misses);
  io.integer("rejected", m.rejected, w.rejected);
  io.text("last_rejection", m.last_rejection, w.last_rejection, Text::sentence);
  io.integer("refused", m.refused, w.refused);
  io.text("second_writer", m.second_writer, w.second_writer, Text::sentence);
}

void describe(WireIo& io, NamedCount& m, handsel_NamedCount& w) {
  io.text("name", m.name, w.name, Text::sentence);
  io.integer("count", m.count, w.count);
}

void describe(WireIo& io, ComponentHealth& m, handsel_ComponentHealth& w) {
  io.text("component", m.component, w.component, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.integer("incarnation", m.incarnation, w.incarnation);
  io.integer("pid", m.pid, w.pid);
  io.choice("state", m.state, w.state, kHealthStateNames);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.flag("job_silent", m.job_silent, w.job_silent);
  io.number("cpu", m.cpu, w.cpu, {0, 1e4});
  io.number("memory_mb", m.memory_mb, w.memory_mb, {0, 1e9});
  io.number("uptime", m.uptime, w.uptime, kTime);
  io.list("topics", m.topics, w.topics, 64);
  io.list("left_out", m.left_out, w.left_out, 32);
}

void describe(WireIo& io, SafetyState& m, handsel_SafetyState& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("revision", m.revision, w.revision);
  io.flag("paused", m.paused, w.paused);
  io.number("override_factor", m.override_factor, w.override_factor, {0, 1});
  io.flag("fault", m.fault, w.fault);
  io.flag("awaits_person", m.awaits_person, w.awaits_person);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.list("lost", m.lost, w.lost, 16);
}

void describe(WireIo& io, SimClock& m, handsel_SimClock& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("incarnation", m.incarnation, w.incarnation);
  io.integer("sequence", m.sequence, w.sequence_number);
  io.number("granted_until", m.granted_until, w.granted_until, kTime);
  io.number("waited", m.waited, w.waited, kTime);
}

void describe(WireIo& io, ClockReached& m, handsel_ClockReached& w) {
  io.text("component", m.component, w.component, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.integer("incarnation", m.incarnation, w.incarnation);
  io.integer("sequence", m.sequence, w.sequence_number);
}

void describe(WireIo& io, SimControl& m, handsel_SimControl& w) {
  io.stamp(m.stamp, w.stamp);
  io.choice("action", m.action, w.action, kSimActionNames);
  io.text("subject", m.subject, w.subject, Text::maybe_empty);
  io.number("value", m.value, w.value, {-1e9, 1e9});
  io.choice("side", m.side, w.side, kSideNames);
  io.point("point", m.point, w.point);
}

void describe(WireIo& io, StudyMark& m, handsel_StudyMark& w) {
  io.stamp(m.stamp, w.stamp);
  io.text("condition", m.condition, w.condition, Text::maybe_empty);
  io.text("participant", m.participant, w.participant, Text::maybe_empty);
  io.integer("trial", m.trial, w.trial);
  io.text("text", m.text, w.text, Text::sentence);
}

void describe(WireIo& io, GroundTruth& m, handsel_GroundTruth& w) {
  io.stamp(m.stamp, w.stamp);
  io.number("sim_time", m.sim_time, w.sim_time, kTime);
  io.number("real_time_factor", m.real_time_factor, w.real_time_factor, {0, 1e6});
  io.text("carrier", m.carrier, w.carrier, Text::maybe_empty);
  io.text("object", m.object, w.object, Text::maybe_empty);
  io.pose("T_world_object", m.T_world_object, w.T_world_object);
  io.text("hold", m.hold, w.hold, Text::maybe_empty);
  io.number("held_time", m.held_time, w.held_time, kTime);
  io.number("constraint_time", m.constraint_time, w.constraint_time, kTime);
  io.number("lifted", m.lifted, w.lifted, kCoordinate);
  io.number("max_lifted", m.max_lifted, w.max_lifted, kCoordinate);
  io.number("human_contact_before_release", m.human_contact_before_release,
            w.human_contact_before_release, kTime);
  io.number("human_alone", m.human_alone, w.human_alone, kTime);
  io.flag("dropped", m.dropped, w.dropped);
  io.flag("handover_done", m.handover_done, w.handover_done);
  io.integer("handovers", m.handovers, w.handovers);
  io.flag("taken", m.taken, w.taken);
  io.choice("taking_side", m.taking_side, w.taking_side, kSideNames);
  io.number("taking_wrist_strain", m.taking_wrist_strain, w.taking_wrist_strain, kFraction);
  io.number("taking_arm_strain", m.taking_arm_strain, w.taking_arm_strain, kFraction);
  io.horizon("separation", m.separation, w.separation, -1e4);
  io.horizon("min_separation", m.min_separation, w.min_separation, -1e4);
  io.horizon("min_robot_distance", m.min_robot_distance, w.min_robot_distance, -1e4);
  io.integer("ssm_violations", m.ssm_violations, w.ssm_violations);
  io.number("peak_closing_speed", m.peak_closing_speed, w.peak_closing_speed, kCoordinate);
  io.number("contact_force", m.contact_force, w.contact_force, {0, 1e9});
  io.number("limit_ratio_velocity", m.limit_ratio_velocity, w.limit_ratio_velocity,
            kReportedLimitRatio);
  io.number("limit_ratio_acceleration", m.limit_ratio_acceleration, w.limit_ratio_acceleration,
            kReportedLimitRatio);
  io.number("limit_ratio_jerk", m.limit_ratio_jerk, w.limit_ratio_jerk, kReportedLimitRatio);
  io.integer("limit_violations", m.limit_violations, w.limit_violations);
  io.integer("self_or_scene_collisions", m.self_or_scene_collisions, w.self_or_scene_collisions);
  io.integer("commanders", m.commanders, w.commanders);
  io.number("setpoint_gap_max", m.setpoint_gap_max, w.setpoint_gap_max, kTime);
  io.integer("set_points", m.set_points, w.set_points);
  io.flag("robot_moving", m.robot_moving, w.robot_moving);
  io.integer("hash", m.hash, w.hash);
  io.list("person", m.person, w.person, 64);
}

HANDSEL_WIRE_KEYED(ComponentHealth, component)
HANDSEL_WIRE(SafetyState)
HANDSEL_WIRE(SimClock)
HANDSEL_WIRE_KEYED(ClockReached, component)
HANDSEL_WIRE(SimControl)
HANDSEL_WIRE(StudyMark)
HANDSEL_WIRE(GroundTruth)

}  // namespace handsel
