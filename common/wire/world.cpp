// SPDX-License-Identifier: Apache-2.0
#include "common/messages/world.hpp"
#include "common/messages/names.hpp"

#include "common/wire/parts.hpp"

namespace handsel {
namespace {
static_assert(handsel_FACT_RELEASED == static_cast<int>(FactKind::released));
}  // namespace

void describe(WireIo& io, ObjectGrip& m, handsel_ObjectGrip& w) {
  io.text("person", m.person, w.person, Text::maybe_empty);
  io.number("force", m.force, w.force, kPush);
}

void describe(WireIo& io, SceneObject& m, handsel_SceneObject& w) {
  io.text("id", m.id, w.id, Text::name);
  io.text("model", m.model, w.model, Text::maybe_empty);
  io.pose("T_world_object", m.T_world_object, w.T_world_object);
  io.choice("holder", m.holder, w.holder, kHolderNames);
  io.text("holder_id", m.holder_id, w.holder_id, Text::maybe_empty);
  io.number("age", m.age, w.age, kTime);
  io.point("velocity", m.velocity, w.velocity);
  io.list("grips", m.grips, w.grips, 8);
  io.part("primitive", m.primitive, w.primitive);
  io.number("uncertainty", m.uncertainty, w.uncertainty, {0, 1e4});
}

void describe(WireIo& io, SceneBox& m, handsel_SceneBox& w) {
  io.text("id", m.id, w.id, Text::name);
  io.pose("T_world_box", m.T_world_box, w.T_world_box);
  io.point("size", m.size, w.size, {0, 1e4});
  io.flag("supports", m.supports, w.supports);
}

void describe(WireIo& io, HandAhead& m, handsel_HandAhead& w) {
  io.number("time", m.time, w.time, {0, 10});
  io.point("position", m.position, w.position);
  io.number("uncertainty", m.uncertainty, w.uncertainty, {0, 1e4});
}

void describe(WireIo& io, HandPrediction& m, handsel_HandPrediction& w) {
  io.text("joint", m.joint, w.joint, Text::name);
  io.list("ahead", m.ahead, w.ahead, 16);
}

void describe(WireIo& io, PalmDirection& m, handsel_PalmDirection& w) {
  io.text("joint", m.joint, w.joint, Text::name);
  io.direction("normal", m.normal, w.normal, true);
}

void describe(WireIo& io, Person& m, handsel_Person& w) {
  io.text("id", m.id, w.id, Text::name);
  io.list("joints", m.joints, w.joints, 64);
  io.number("stature", m.stature, w.stature, {0.3, 3});
  io.flag("gaze_known", m.gaze_known, w.gaze_known);
  io.point("gaze_origin", m.gaze_origin, w.gaze_origin);
  io.direction("gaze_direction", m.gaze_direction, w.gaze_direction, m.gaze_known);
  io.number("age", m.age, w.age, kTime);
  io.number("inflation", m.inflation, w.inflation, {0, 1e4});
  io.list("hands", m.hands, w.hands, 2);
  io.list("palms", m.palms, w.palms, 2);
}

void describe(WireIo& io, Fact& m, handsel_Fact& w) {
  io.choice("kind", m.kind, w.kind, kFactNames);
  io.text("subject", m.subject, w.subject, Text::name);
  io.text("object", m.object, w.object, Text::maybe_empty);
  io.number("value", m.value, w.value, {-1e9, 1e9});
  io.number("since", m.since, w.since, kTime);
  io.text("evidence", m.evidence, w.evidence, Text::sentence);
}

void describe(WireIo& io, Scene& m, handsel_Scene& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("revision", m.revision, w.revision);
  io.flag("robot_known", m.robot_known, w.robot_known);
  io.pose("T_world_base", m.T_world_base, w.T_world_base);
  io.vector("robot_position", m.robot_position, w.robot_position, kCoordinate);
  io.list("objects", m.objects, w.objects, 64);
  io.list("boxes", m.boxes, w.boxes, 64);
  io.integer("left_out", m.left_out, w.left_out);
  io.check(m.robot_known == (m.robot_position.size() > 0), "robot_position",
           "must be there exactly when robot_known is true");
}

void describe(WireIo& io, SourceView& m, handsel_SourceView& w) {
  io.text("source", m.source, w.source, Text::name);
  io.point("low", m.low, w.low);
  io.point("high", m.high, w.high);
  io.number("age", m.age, w.age, kTime);
  io.flag("live", m.live, w.live);
  io.text("reason", m.reason, w.reason, Text::sentence);
}

void describe(WireIo& io, OtherRobot& m, handsel_OtherRobot& w) {
  io.text("name", m.name, w.name, Text::name);
  io.list("parts", m.parts, w.parts, 128);
  io.number("age", m.age, w.age, kTime);
}

void describe(WireIo& io, HumanState& m, handsel_HumanState& w) {
  io.stamp(m.stamp, w.stamp);
  io.list("people", m.people, w.people, 16);
  io.flag("covered", m.covered, w.covered);
  io.list("views", m.views, w.views, 16);
  io.integer("left_out", m.left_out, w.left_out);
  io.list("robots", m.robots, w.robots, 4);
}

void describe(WireIo& io, Facts& m, handsel_Facts& w) {
  io.stamp(m.stamp, w.stamp);
  io.list("facts", m.facts, w.holding, 256);
  io.integer("left_out", m.left_out, w.left_out);
}

void describe(WireIo& io, Costmap& m, handsel_Costmap& w) {
  io.text("layer", m.layer, w.layer, Text::name);
  io.text("person", m.person, w.person, Text::maybe_empty);
  io.stamp(m.stamp, w.stamp);
  io.integer("revision", m.revision, w.revision);
  io.point("origin", m.origin, w.origin);
  io.number("resolution", m.resolution, w.resolution, {0, 10, true});
  io.integer("nx", m.nx, w.nx, 0, 1024);
  io.integer("ny", m.ny, w.ny, 0, 1024);
  io.integer("nz", m.nz, w.nz, 0, 1024);
  io.number("weight", m.weight, w.weight, {0, 1e3});
  io.bytes("values", m.values, w.values, 1048576);
  io.check(std::size_t{m.nx} * m.ny * m.nz == m.values.size(), "values", "are not nx*ny*nz");
}

HANDSEL_WIRE(Scene)
HANDSEL_WIRE(HumanState)
HANDSEL_WIRE(Facts)
HANDSEL_WIRE_KEYED(Costmap, layer)

}  // namespace handsel
