// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/action_dispatch.hpp"

#include <utility>

namespace handsel::supervisor {

bool ActionDispatch::begin(const ActionGoal& goal, const std::optional<ActionStatus>& running,
                           std::uint64_t& next_id) {
  state_ = State::running;
  const bool same = !has_begun_ && running && running->state == ActionState::running &&
                    running->task == goal.task && running->kind == goal.kind &&
                    goal.kind != ActionKind::place && running->object == goal.object &&
                    running->human == goal.human;
  has_begun_ = true;
  id_ = same ? running->id : ++next_id;
  return same;
}

void ActionDispatch::send(ActionGoal goal, TimePoint now, std::vector<ActionGoal>& out) {
  goal.id = id_;
  out.push_back(std::move(goal));
  sent_ = now;
}

void ActionDispatch::stop(const std::string& reason, TimePoint now, std::vector<ActionGoal>& out) {
  cancel(out);
  sent_ = now;
  state_ = State::stopping;
  stop_reason_ = reason;
}

void ActionDispatch::cancel(std::vector<ActionGoal>& out) const {
  ActionGoal goal;
  goal.id = id_;
  goal.cancel = true;
  out.push_back(goal);
}

bool ActionDispatch::end() { return std::exchange(state_, State::idle) == State::stopping; }

}  // namespace handsel::supervisor
