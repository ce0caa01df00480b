// SPDX-License-Identifier: Apache-2.0
#include "common/wire/parts.hpp"

#include "common/messages/names.hpp"

namespace handsel {

void describe(WireIo& io, Refusal& m, handsel_Refusal& w) {
  io.text("what", m.what, w.what, Text::sentence);
  io.text("reason", m.reason, w.reason, Text::sentence);
}

void describe(WireIo& io, Segment& m, handsel_Segment& w) {
  io.number("duration", m.duration, w.duration, kPeriod);
  io.number("jerk", m.jerk, w.jerk, {-1e9, 1e9});
}

void describe(WireIo& io, AxisTrajectory& m, handsel_AxisTrajectory& w) {
  io.number("start_position", m.start.position, w.start_position, kCoordinate);
  io.number("start_velocity", m.start.velocity, w.start_velocity, kCoordinate);
  io.number("start_acceleration", m.start.acceleration, w.start_acceleration, kAcceleration);
  io.list("segments", m.segments, w.segments, 4096);
}

void describe(WireIo& io, Trajectory& m, handsel_SoftMotion& w) {
  io.list("axes", m.axes, w.axes, kMaxAxes);
  if (!io.converting()) return;
  double first = 0;
  for (std::size_t i = 0; i < m.axes.size(); ++i) {
    double sum = 0;
    for (const Segment& s : m.axes[i].segments) sum += s.duration;
    if (i == 0) first = sum;
    io.check(std::abs(sum - first) <= 1e-6, "axes", "do not last equally long");
  }
}

void describe(WireIo& io, Attachment& m, handsel_Attachment& w) {
  io.text("object", m.object, w.object, Text::maybe_empty);
  io.pose("T_tool_object", m.T_tool_object, w.T_tool_object);
  io.text("hand", m.hand, w.hand, Text::maybe_empty);
}

void describe(WireIo& io, MovingPart& m, handsel_MovingPart& w) {
  io.point("a", m.a, w.a);
  io.point("b", m.b, w.b);
  io.number("radius", m.radius, w.radius, {0, 100});
  io.point("velocity_a", m.velocity_a, w.velocity_a);
  io.point("velocity_b", m.velocity_b, w.velocity_b);
}

void describe(WireIo& io, Primitive& m, handsel_Primitive& w) {
  io.choice("kind", m.kind, w.kind, kPrimitiveNames);
  io.point("size", m.size, w.size, {0, 1e4});
}

void describe(WireIo& io, RequestId& m, handsel_RequestId& w) {
  io.integer("client", m.client, w.client);
  io.integer("number", m.number, w.number);
}

void describe(WireIo& io, BodyJoint& m, handsel_BodyJoint& w) {
  io.text("name", m.name, w.name, Text::name);
  io.point("position", m.position, w.position);
  io.point("velocity", m.velocity, w.velocity);
  io.number("age", m.age, w.age, kTime);
}

void describe(WireIo& io, Vector& m, handsel_AxisPoint& w) {
  io.vector("values", m, w.values, kCoordinate);
}

}  // namespace handsel
