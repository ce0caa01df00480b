// Task goals that wait for the next cycle of the supervisor, bounded, each id once. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "common/messages/task.hpp"

namespace handsel::supervisor {

/// Pause, resume, cancel, acknowledge, speed, clear_person: they have room of their own, so that a flood of tasks does not keep them out.
inline bool is_control(TaskKind kind) { return kind >= TaskKind::pause; }

class GoalInbox {
 public:
  /// `max`: tasks that may wait, and as many controls.
  explicit GoalInbox(std::size_t max) : max_(max) {}

  enum class Admission {
    taken,
    known,        ///< its id came before
    turned_away,  ///< as many as may wait do; it is refused in the next cycle, or only counted when too many are refused already
  };
  Admission put(const TaskGoal& goal);
  /// The goals that wait, in the order in which they came.
  std::vector<TaskGoal> take();
  /// A goal that cannot be answered yet waits for the next cycle.
  void put_back(const TaskGoal& goal) { waiting_.push_back(goal); }
  /// Goals to refuse, for want of room.
  std::vector<TaskGoal> take_turned_away();

  bool empty() const { return waiting_.empty(); }
  std::size_t size() const { return waiting_.size(); }
  std::size_t max() const { return max_; }
  bool knows(std::uint64_t id) const;
  std::uint64_t turned_away() const { return turned_away_; }  ///< so far

 private:
  std::size_t max_;
  std::vector<TaskGoal> waiting_, to_refuse_;
  std::deque<std::uint64_t> known_;  // the newest
  std::uint64_t turned_away_{0};
};

}  // namespace handsel::supervisor
