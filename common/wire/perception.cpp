// SPDX-License-Identifier: Apache-2.0
#include "common/messages/perception.hpp"

#include "common/wire/parts.hpp"
#include "idl/perception.h"

namespace handsel {

void describe(WireIo& io, ObservedJoint& m, handsel_ObservedJoint& w) {
  io.text("name", m.name, w.name, Text::name);
  io.point("position", m.position, w.position);
  io.number("confidence", m.confidence, w.confidence, kFraction);
}

void describe(WireIo& io, ObservedPerson& m, handsel_ObservedPerson& w) {
  io.text("body", m.body, w.body, Text::name);
  const std::size_t without = io.spared_list("joints", m.joints, w.joints, 64);
  const bool gaze = io.spare([&] {
    io.flag("has_gaze", m.has_gaze, w.has_gaze);
    io.point("gaze_origin", m.gaze_origin, w.gaze_origin);
    io.direction("gaze_direction", m.gaze_direction, w.gaze_direction, m.has_gaze);
  });
  if (!io.converting() || (without == 0 && gaze)) return;
  if (!gaze) {
    m.has_gaze = false;
    m.gaze_origin.setZero();
    m.gaze_direction = Vector3::UnitX();
  }
  io.check(!m.joints.empty() || m.has_gaze, "joints",
           "hold no well-formed joint, and there is no well-formed gaze");
}

void describe(WireIo& io, Coverage& m, handsel_Coverage& w) {
  io.point("low", m.low, w.low);
  io.point("high", m.high, w.high);
  io.check((m.low.array() <= m.high.array()).all(), "high", "lies below low");
}

void describe(WireIo& io, RobotReport& m, handsel_RobotReport& w) {
  io.text("robot", m.robot, w.robot, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.list("parts", m.parts, w.parts, 128);
}

void describe(WireIo& io, ObservedGrip& m, handsel_ObservedGrip& w) {
  io.point("position", m.position, w.position);
  io.number("force", m.force, w.force, kPush);
}

void describe(WireIo& io, ObservedObject& m, handsel_ObservedObject& w) {
  io.text("id", m.id, w.id, Text::name);
  io.text("model", m.model, w.model, Text::maybe_empty);
  io.pose("T_world_object", m.T_world_object, w.T_world_object);
  io.number("confidence", m.confidence, w.confidence, kFraction);
  io.list("grips", m.grips, w.grips, 8);
  io.part("primitive", m.primitive, w.primitive);
}

void describe(WireIo& io, HumanObservation& m, handsel_HumanObservation& w) {
  io.text("source", m.source, w.source, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.part("coverage", m.coverage, w.coverage);
  // An omitted person may be anywhere: then the source has observed no region as empty.
  if (io.spared_list("people", m.people, w.people, 256) > 0) m.coverage.high = m.coverage.low;
}

void describe(WireIo& io, ObjectObservation& m, handsel_ObjectObservation& w) {
  io.text("source", m.source, w.source, Text::name);
  io.stamp(m.stamp, w.stamp);
  io.spared_list("objects", m.objects, w.objects, 1024);
}

HANDSEL_WIRE_KEYED(HumanObservation, source)
HANDSEL_WIRE_KEYED(ObjectObservation, source)
HANDSEL_WIRE_KEYED(RobotReport, robot)

}  // namespace handsel
