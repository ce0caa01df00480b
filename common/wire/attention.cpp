// SPDX-License-Identifier: Apache-2.0
#include "common/messages/attention.hpp"
#include "common/messages/names.hpp"

#include "common/wire/parts.hpp"
#include "idl/attention.h"

namespace handsel {
void describe(WireIo& io, BehaviourState& m, handsel_BehaviourState& w) {
  io.text("name", m.name, w.name, Text::name);
  io.choice("behaviour", m.behaviour, w.behaviour, kBehaviourNames);
  io.number("period", m.period, w.period, kPeriod);
  io.integer("activations", m.activations, w.activations);
  io.integer("activations_at_fastest", m.activations_at_fastest, w.activations_at_fastest);
  io.flag("released", m.released, w.released);
  io.number("stimulus", m.stimulus, w.stimulus, {-1e9, 1e9});
  io.number("speed_factor", m.speed_factor, w.speed_factor, kSigned);
  io.flag("winner", m.winner, w.winner);
  io.text("reason", m.reason, w.reason, Text::sentence);
}

void describe(WireIo& io, AttentionState& m, handsel_AttentionState& w) {
  io.stamp(m.stamp, w.stamp);
  io.list("behaviours", m.behaviours, w.behaviours, 16);
}

void describe(WireIo& io, AttentionAdvice& m, handsel_AttentionAdvice& w) {
  io.stamp(m.stamp, w.stamp);
  io.number("speed_factor", m.speed_factor, w.speed_factor, kSigned);
  io.text("limiting", m.limiting, w.limiting, Text::maybe_empty);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.flag("has_gaze_target", m.has_gaze_target, w.has_gaze_target);
  io.point("gaze_target", m.gaze_target, w.gaze_target);
  io.flag("leaves_path", m.leaves_path, w.leaves_path);
  io.flag("has_target_shift", m.has_target_shift, w.has_target_shift);
  io.point("target_shift", m.target_shift, w.target_shift);
  io.number("cost_gain", m.cost_gain, w.cost_gain, {0, 1e3});
  io.number("people_period", m.people_period, w.people_period, kPeriod);
  io.number("objects_period", m.objects_period, w.objects_period, kPeriod);
  io.number("forecast_period", m.forecast_period, w.forecast_period, kPeriod);
  io.number("cost_map_period", m.cost_map_period, w.cost_map_period, kPeriod);
  io.number("replan_period", m.replan_period, w.replan_period, kPeriod);
  io.choice("change", m.change, w.change, kTaskChangeNames);
  io.text("person", m.person, w.person, Text::maybe_empty);
}

void describe(WireIo& io, SensorRequest& m, handsel_SensorRequest& w) {
  io.text("source", m.source, w.source, Text::maybe_empty);
  io.stamp(m.stamp, w.stamp);
  io.number("people_rate", m.people_rate, w.people_rate, {0, 1e4});
  io.flag("hands", m.hands, w.hands);
  io.number("objects_rate", m.objects_rate, w.objects_rate, {0, 1e4});
  io.number("region_rate", m.region_rate, w.region_rate, {0, 1e4});
  io.part("region", m.region, w.region);
  io.texts("objects", m.objects, w.objects, 16);
}

HANDSEL_WIRE(AttentionState)
HANDSEL_WIRE(AttentionAdvice)
HANDSEL_WIRE_KEYED(SensorRequest, source)

}  // namespace handsel
