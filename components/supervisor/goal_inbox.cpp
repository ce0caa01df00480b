// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/goal_inbox.hpp"

#include <algorithm>
#include <utility>

namespace handsel::supervisor {
namespace {
constexpr std::size_t kMaxKnownGoals = 256;  // max number of stored ids
}  // namespace

bool GoalInbox::knows(std::uint64_t id) const {
  return std::find(known_.begin(), known_.end(), id) != known_.end();
}

GoalInbox::Admission GoalInbox::put(const TaskGoal& goal) {
  if (knows(goal.id)) return Admission::known;
  const auto same = std::count_if(waiting_.begin(), waiting_.end(), [&](const TaskGoal& other) {
    return is_control(other.kind) == is_control(goal.kind);
  });
  if (static_cast<std::size_t>(same) >= max_) {
    ++turned_away_;
    if (to_refuse_.size() < max_) to_refuse_.push_back(goal);
    return Admission::turned_away;
  }
  known_.push_back(goal.id);
  if (known_.size() > kMaxKnownGoals) known_.pop_front();
  waiting_.push_back(goal);
  return Admission::taken;
}

std::vector<TaskGoal> GoalInbox::take() { return std::exchange(waiting_, {}); }

std::vector<TaskGoal> GoalInbox::take_turned_away() { return std::exchange(to_refuse_, {}); }

}  // namespace handsel::supervisor
