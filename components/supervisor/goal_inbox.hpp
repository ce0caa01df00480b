// Task goals that wait for the next cycle of the supervisor, bounded, each id once. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "common/messages/task.hpp"

namespace handsel::supervisor {

/// Pause, resume, cancel, acknowledge, speed, clear_person: they have room of their own, so that a
/// flood of tasks does not keep them out.
inline bool is_control(TaskKind kind) {
  return kind >= TaskKind::pause && kind <= TaskKind::clear_person;
}

class GoalInbox {
 public:
  /// `max`: tasks that may wait, and as many controls.
  explicit GoalInbox(std::size_t max) : max_(max) {}

  enum class Admission {
    taken,
    known,  ///< the id came before
    /// As many as may wait do; the goal is refused in the next cycle, or only counted when too many
    /// are refused already.
    turned_away,
  };
  /// Queues a goal for the next cycle and remembers its id. Tasks and controls are counted
  /// separately; the newest 256 ids are remembered.
  Admission put(const TaskGoal& goal);
  /// The goals that wait, in the order in which they came.
  std::vector<TaskGoal> take();
  /// A goal that cannot be answered yet waits for the next cycle.
  void put_back(const TaskGoal& goal) { waiting_.push_back(goal); }
  /// Goals to refuse, for want of room.
  std::vector<TaskGoal> take_turned_away();

  /// Returns whether no goal waits; goals to refuse do not count.
  bool empty() const { return waiting_.empty(); }
  /// Number of goals that wait, tasks and controls together.
  std::size_t size() const { return waiting_.size(); }
  /// Number of tasks that may wait, and separately of controls.
  std::size_t max() const { return max_; }
  /// Returns whether a goal with this id was taken and is still remembered.
  bool knows(std::uint64_t id) const;
  std::uint64_t turned_away() const { return turned_away_; }  ///< so far

 private:
  std::size_t max_;
  std::vector<TaskGoal> waiting_, to_refuse_;
  std::deque<std::uint64_t> known_;  // the newest
  std::uint64_t turned_away_{0};
};

}  // namespace handsel::supervisor
