// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/progress.hpp"

#include <algorithm>

namespace handsel::supervisor {
namespace {

constexpr std::uint32_t kMaxDepth = 16;  // max depth of the tree, as in idl/task.idl

bool over(StepState state) {
  return state == StepState::done || state == StepState::failed || state == StepState::dropped;
}

/// Returns the state of a task from its parts: [first, last) of the tree.
StepState together(const std::vector<PlanStep>& tree, std::size_t first, std::size_t last,
                   const std::vector<bool>& leaf) {
  bool waiting = false, done = false, failed = false, dropped = false;
  for (std::size_t i = first; i < last; ++i) {
    if (!leaf[i]) continue;
    if (tree[i].state == StepState::running) return StepState::running;
    waiting = waiting || tree[i].state == StepState::waiting;
    done = done || tree[i].state == StepState::done;
    failed = failed || tree[i].state == StepState::failed;
    dropped = dropped || tree[i].state == StepState::dropped;
  }
  if (waiting) return done ? StepState::running : StepState::waiting;
  return failed ? StepState::failed : dropped ? StepState::dropped : StepState::done;
}

std::size_t end_of(const std::vector<PlanStep>& tree, std::size_t line) {
  std::size_t end = line + 1;
  while (end < tree.size() && tree[end].depth > tree[line].depth) ++end;
  return end;
}

}  // namespace

std::string cut(const std::string& text, std::size_t max_size) {
  return text.size() <= max_size ? text : text.substr(0, max_size - 3) + "...";
}

void Progress::mark(StepState state, const std::string& reason) {
  if (next_ >= marks_.size()) return;
  marks_[next_].state = state;
  if (!reason.empty() || state == StepState::done) marks_[next_].reason = reason;
}

void Progress::note_dropped(const std::string& reason) {
  if (!reason.empty() && std::find(dropped_.begin(), dropped_.end(), reason) == dropped_.end())
    dropped_.push_back(reason);
}

void Progress::done() {
  mark(StepState::done, "");
  ++next_;
}

void Progress::drop(const std::string& reason) {
  mark(StepState::dropped, reason);
  note_dropped(reason);
}

std::vector<PlannedAction> Progress::left(bool after) const {
  const std::size_t from = std::min(plan_.actions.size(), next_ + (after ? 1 : 0));
  return {plan_.actions.begin() + static_cast<std::ptrdiff_t>(from), plan_.actions.end()};
}

/// Keeps finished lines in the tree.
void Progress::put_away() {
  for (std::size_t i = 1; i < plan_.tree.size(); ++i) {
    const PlanLine& line = plan_.tree[i];
    if (line.action >= 0) {
      const Mark& m = marks_[static_cast<std::size_t>(line.action)];
      if (over(m.state)) past_.push_back({line.text, line.depth, m.state, m.reason});
      continue;
    }
    bool any = false;
    for (std::size_t k = i + 1; k < plan_.tree.size() && plan_.tree[k].depth > line.depth; ++k)
      any = any || (plan_.tree[k].action >= 0 &&
                    over(marks_[static_cast<std::size_t>(plan_.tree[k].action)].state));
    if (any) past_.push_back({line.text, line.depth, StepState::waiting, ""});
  }
  for (std::size_t i = 0; i < plan_.actions.size(); ++i)
    if (over(marks_[i].state)) past_plan_.push_back(plan_.actions[i].text());
}

void Progress::adopt(Plan plan, const std::function<std::string(const PlannedAction&)>& why) {
  for (std::size_t i = next_; i < plan_.actions.size(); ++i) {
    Mark& m = marks_[i];
    if (over(m.state) ||
        std::find(plan.actions.begin(), plan.actions.end(), plan_.actions[i]) != plan.actions.end())
      continue;
    m = {StepState::dropped, why(plan_.actions[i])};
    note_dropped(m.reason);
  }
  put_away();
  plan_ = std::move(plan);
  marks_.assign(plan_.actions.size(), {});
  next_ = 0;
}

void Progress::adopt_after_running(Plan plan,
                                   const std::function<std::string(const PlannedAction&)>& why) {
  const PlannedAction running = plan_.actions[next_];
  const Mark mark = marks_[next_];
  for (PlanLine& line : plan.tree)
    if (line.action >= 0) ++line.action;
  if (plan.tree.empty()) plan.tree.push_back({});
  plan.tree.insert(plan.tree.begin() + 1, PlanLine{running.text(), 1, 0, false, ""});
  plan.actions.insert(plan.actions.begin(), running);
  adopt(std::move(plan), why);
  marks_.front() = mark;
}

void Progress::write(const std::string& goal, TaskStatus& out) const {
  out.plan = past_plan_;
  for (const auto& action : plan_.actions) out.plan.push_back(cut(action.text(), kMaxText));
  out.step = static_cast<std::uint32_t>(past_plan_.size() + next_);
  if (out.plan.size() > kMaxSteps) {  // removes the first finished actions
    const std::size_t removed =
        std::min<std::size_t>(out.step > 8 ? out.step - 8 : 0, out.plan.size() - kMaxSteps);
    out.plan.erase(out.plan.begin(), out.plan.begin() + static_cast<std::ptrdiff_t>(removed));
    out.step -= static_cast<std::uint32_t>(removed);
    if (out.plan.size() > kMaxSteps) out.plan.resize(kMaxSteps);
    out.step = std::min<std::uint32_t>(out.step, kMaxSteps);
  }
  out.cost = 0;
  for (const auto& action : left()) out.cost += action.cost;

  std::vector<PlanStep> tree{{cut(goal, kMaxText), 0, StepState::waiting, ""}};
  tree.insert(tree.end(), past_.begin(), past_.end());
  std::vector<bool> leaf(tree.size(), false);
  for (std::size_t i = 1; i < past_.size() + 1; ++i) leaf[i] = end_of(tree, i) == i + 1;
  for (std::size_t i = 1; i < plan_.tree.size(); ++i) {
    const PlanLine& line = plan_.tree[i];
    PlanStep step{cut(line.text, kMaxText), line.depth, StepState::done, line.reason};
    if (line.action >= 0) {
      step.state = marks_[static_cast<std::size_t>(line.action)].state;
      step.reason = marks_[static_cast<std::size_t>(line.action)].reason;
    } else if (line.skipped) {
      step.state = StepState::failed;
    }
    tree.push_back(std::move(step));
    leaf.push_back(line.action >= 0);
  }
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::size_t end = end_of(tree, i);
    if (!leaf[i] && end > i + 1) tree[i].state = together(tree, i + 1, end, leaf);
  }
  if (tree.size() > kMaxLines) {
    const std::size_t removed = std::min(past_.size(), tree.size() - kMaxLines);
    tree.erase(tree.begin() + 1, tree.begin() + 1 + static_cast<std::ptrdiff_t>(removed));
    if (tree.size() > kMaxLines) tree.resize(kMaxLines);
  }
  for (PlanStep& step : tree) {
    step.depth = std::min(step.depth, kMaxDepth);
    step.reason = cut(step.reason, kMaxReason);
  }
  out.tree = std::move(tree);
}

}  // namespace handsel::supervisor
