// SPDX-License-Identifier: Apache-2.0
#include "common/messages/robot.hpp"
#include "common/messages/names.hpp"

#include "common/wire/parts.hpp"
#include "idl/robot.h"

namespace handsel {
void describe(WireIo& io, OtherHand& m, handsel_OtherHand& w) {
  io.text("group", m.group, w.group, Text::name);
  io.wrench("wrist_wrench", m.wrist_wrench, w.wrist_wrench);
  io.number("hand_effort", m.hand_effort, w.hand_effort, {0, 1e5});
  io.number("payload", m.payload, w.payload, {-1e3, 1e3});
}

void describe(WireIo& io, ServoReference& m, handsel_ServoReference& w) {
  io.vector("position", m.position, w.position, kCoordinate);
  io.vector("effort", m.effort, w.effort, kCoordinate);
  io.number("payload", m.payload, w.payload, {0, 1e3});
  io.vector("other_payloads", m.other_payloads, w.other_payloads, {0, 1e3}, 3);
  const auto n = m.position.size();
  io.check(m.effort.size() == n || m.effort.size() == 0, "effort",
           "has not as many values as position");
}

void describe(WireIo& io, RobotState& m, handsel_RobotState& w) {
  io.text("robot", m.robot, w.robot, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.integer("sequence", m.sequence, w.sequence_number);
  io.pose("T_world_base", m.T_world_base, w.T_world_base);
  io.number("localisation_age", m.localisation_age, w.localisation_age, {0, 1e6});
  io.vector("position", m.position, w.position, kCoordinate);
  io.vector("velocity", m.velocity, w.velocity, kCoordinate);
  io.vector("effort", m.effort, w.effort, kForce);
  io.part("reference", m.reference, w.reference);
  io.vector("external_torque", m.external_torque, w.external_torque, kForce);
  io.wrench("wrist_wrench", m.wrist_wrench, w.wrist_wrench);
  io.number("hand_effort", m.hand_effort, w.hand_effort, {0, 1e5});
  io.number("payload", m.payload, w.payload, {-1e3, 1e3});
  io.choice("mode", m.mode, w.mode, kDriveModeNames);
  io.list("other_hands", m.other_hands, w.other_hands, 3);
  io.integer("refused_set_points", m.refused_set_points, w.refused_set_points);
  io.text("refusal", m.refusal, w.refusal, Text::sentence);
  const auto n = m.position.size();
  io.check(n > 0, "position", "is empty, one value per axis is needed");
  io.check(m.velocity.size() == n, "velocity", "has not as many values as position");
  io.check(m.effort.size() == n || m.effort.size() == 0, "effort",
           "has not as many values as position");
  const auto held = m.reference.position.size();
  io.check(held == n || held == 0, "reference", "has not as many values as position");
  io.check(m.external_torque.size() == n || m.external_torque.size() == 0, "external_torque",
           "has not as many values as position");
}

void describe(WireIo& io, JointCommand& m, handsel_JointCommand& w) {
  io.text("robot", m.robot, w.robot, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.integer("sequence", m.sequence, w.sequence_number);
  io.vector("position", m.position, w.position, kCoordinate);
  io.vector("velocity", m.velocity, w.velocity, kCoordinate);
  io.vector("acceleration", m.acceleration, w.acceleration, kAcceleration);
  io.vector("effort", m.effort, w.effort, kCoordinate);
  io.number("payload", m.payload, w.payload, {0, 1e3});
  io.vector("other_payloads", m.other_payloads, w.other_payloads, {0, 1e3}, 3);
  const auto n = m.position.size();
  io.check(n > 0, "position", "is empty, one value per axis is needed");
  io.check(m.velocity.size() == n, "velocity", "has not as many values as position");
  io.check(m.acceleration.size() == n, "acceleration", "has not as many values as position");
  io.check(m.effort.size() == n || m.effort.size() == 0, "effort",
           "has neither as many values as position nor none");
}

HANDSEL_WIRE_KEYED(RobotState, robot)
HANDSEL_WIRE_KEYED(JointCommand, robot)

}  // namespace handsel
