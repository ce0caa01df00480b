// SPDX-License-Identifier: Apache-2.0
// A bounded queue of task goals for the next cycle of the supervisor, each id once. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "common/messages/task.hpp"

namespace handsel::supervisor {

/// Returns whether the kind is a control: pause, resume, cancel, acknowledge, speed, clear_person.
/// Controls have a separate quota, so that many tasks do not exclude them.
inline bool is_control(TaskKind kind) {
  return kind >= TaskKind::pause && kind <= TaskKind::clear_person;
}

class GoalInbox {
 public:
  /// `max`: max number of waiting tasks, and of waiting controls.
  explicit GoalInbox(std::size_t max) : max_(max) {}

  enum class Admission {
    taken,
    known,  ///< a goal with this id was received before
    /// The quota is reached; the goal is refused in the next cycle, or only counted if too many are
    /// refused already.
    turned_away,
  };
  /// Queues a goal for the next cycle and stores its id. Tasks and controls have separate quotas;
  /// the newest 256 ids are stored.
  Admission put(const TaskGoal& goal);
  /// Removes and returns the waiting goals in the order of arrival.
  std::vector<TaskGoal> take();
  /// Returns a goal that cannot be answered yet to the queue for the next cycle.
  void put_back(const TaskGoal& goal) { waiting_.push_back(goal); }
  /// Returns the goals to refuse because of the quota.
  std::vector<TaskGoal> take_turned_away();

  /// Returns whether no goal waits, except goals to refuse.
  bool empty() const { return waiting_.empty(); }
  /// Returns the number of waiting tasks and controls.
  std::size_t size() const { return waiting_.size(); }
  /// Returns the max number of waiting tasks, and of waiting controls.
  std::size_t max() const { return max_; }
  /// Returns whether a goal with this id was taken and its id is still stored.
  bool knows(std::uint64_t id) const;
  std::uint64_t turned_away() const { return turned_away_; }  ///< so far

 private:
  std::size_t max_;
  std::vector<TaskGoal> waiting_, to_refuse_;
  std::deque<std::uint64_t> known_;  // the newest
  std::uint64_t turned_away_{0};
};

}  // namespace handsel::supervisor
