// SPDX-License-Identifier: Apache-2.0
#include "common/messages/task.hpp"
#include "common/messages/names.hpp"

#include "common/wire/parts.hpp"
#include "idl/task.h"

namespace handsel {
namespace {

constexpr const char* kActionStates[] = {"idle", "running", "succeeded", "failed", "cancelled"};

}  // namespace

void describe(WireIo& io, TaskGoal& m, handsel_TaskGoal& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("id", m.id, w.id);
  io.choice("kind", m.kind, w.kind, kTaskKindNames);
  io.text("object", m.object, w.object, Text::maybe_empty);
  io.text("human", m.human, w.human, Text::maybe_empty);
  io.text("surface", m.surface, w.surface, Text::maybe_empty);
  io.number("value", m.value, w.value, {-1e9, 1e9});
  io.check(m.kind != TaskKind::speed || (m.value >= 0 && m.value <= 1), "value",
           "must be from 0 to 1 for a speed goal");
  io.point("place", m.place, w.place);
  io.text("onto", m.onto, w.onto, Text::maybe_empty);
}

void describe(WireIo& io, PlanStep& m, handsel_PlanStep& w) {
  io.text("text", m.text, w.text, Text::sentence);
  io.integer("depth", m.depth, w.depth, 0, 16);
  io.choice("state", m.state, w.state, kStepStateNames);
  io.text("reason", m.reason, w.reason, Text::sentence);
}

void describe(WireIo& io, TaskStatus& m, handsel_TaskStatus& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("id", m.id, w.id);
  io.choice("kind", m.kind, w.kind, kTaskKindNames);
  io.choice("state", m.state, w.state, kTaskStateNames);
  io.texts("plan", m.plan, w.plan, 64, Text::sentence, true);
  io.integer("step", m.step, w.step);
  io.text("phase", m.phase, w.phase, Text::sentence);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.list("refusals", m.refusals, w.refusals, 256, true);
  io.list("tree", m.tree, w.tree, 128, true);
  io.number("cost", m.cost, w.cost, {0, 1e9});
  io.check(m.step <= m.plan.size(), "step", "is beyond the end of plan");
}

void describe(WireIo& io, ActionGoal& m, handsel_ActionGoal& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("id", m.id, w.id);
  io.integer("task", m.task, w.task);
  io.integer("epoch", m.epoch, w.epoch);
  io.choice("kind", m.kind, w.kind, kActionKindNames);
  io.flag("cancel", m.cancel, w.cancel);
  io.text("object", m.object, w.object, Text::maybe_empty);
  io.text("human", m.human, w.human, Text::maybe_empty);
  io.text("surface", m.surface, w.surface, Text::maybe_empty);
  io.flag("has_goal", m.has_goal, w.has_goal);
  io.pose("T_world_goal", m.T_world_goal, w.T_world_goal);
  io.flag("both_hands", m.both_hands, w.both_hands);
}

void describe(WireIo& io, ActionStatus& m, handsel_ActionStatus& w) {
  io.stamp(m.stamp, w.stamp);
  io.integer("id", m.id, w.id);
  io.integer("task", m.task, w.task);
  io.choice("kind", m.kind, w.kind, kActionKindNames);
  io.choice("state", m.state, w.state, kActionStates);
  io.choice("phase", m.phase, w.phase, kActionPhaseTexts);
  io.text("object", m.object, w.object, Text::maybe_empty);
  io.text("human", m.human, w.human, Text::maybe_empty);
  io.flag("holding", m.holding, w.holding);
  io.flag("exchange_engaged", m.exchange_engaged, w.exchange_engaged);
  io.point("exchange_point", m.exchange_point, w.exchange_point);
  io.horizon("time_to_handover", m.time_to_handover, w.time_to_handover, 0);
  io.flag("has_partner", m.has_partner, w.has_partner);
  io.choice("partner_side", m.partner_side, w.partner_side, kSideNames);
  io.pose("T_world_partner_wrist", m.T_world_partner_wrist, w.T_world_partner_wrist);
  io.number("partner_strain", m.partner_strain, w.partner_strain, {0, 1e3});
  io.choice("failure", m.failure, w.failure, kActionFailureNames);
  io.text("reason", m.reason, w.reason, Text::sentence);
  io.list("refusals", m.refusals, w.refusals, 256, true);
}

HANDSEL_WIRE(TaskGoal)
HANDSEL_WIRE(TaskStatus)
HANDSEL_WIRE(ActionGoal)
HANDSEL_WIRE(ActionStatus)

}  // namespace handsel
