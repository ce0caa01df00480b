// A command's seat in a running system: a DDS participant, an observer, and Ctrl-C as a flag.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/bus/dds/dds_bus.hpp"
#include "deploy/handsel/system/observer.hpp"

namespace handsel {

/// Turns SIGINT and SIGTERM into a flag for the life of the process; the second SIGINT ends it at once.
void catch_interrupts();
bool interrupted();

class Session {
 public:
  /// Throws MissingError when the domain cannot be entered.
  explicit Session(int domain);

  DdsBus& bus() { return bus_; }
  Observer& observer() { return observer_; }
  const Snapshot& snapshot() const { return observer_.snapshot(); }
  /// Listens until `done` holds, `limit` has passed or Ctrl-C; true if it held.
  bool wait(Duration limit, const std::function<bool()>& done);
  /// Listens for a while, or until Ctrl-C.
  void listen(Duration time) {
    wait(time, [] { return false; });
  }
  /// Throws MissingError when no component is heard within 1 s.
  void require_system();
  /// Publishes a goal as soon as a supervisor listens; false when none did within 1 s.
  bool send(const TaskGoal& goal);
  /// Publishes a goal to who listens now.
  bool publish(const TaskGoal& goal) { return goals_->publish(goal); }
  std::uint64_t new_task_id();

 private:
  int domain_;
  DdsBus bus_;
  Observer observer_;
  std::unique_ptr<Publisher<TaskGoal>> goals_;
  std::uint64_t next_task_;
};

}  // namespace handsel
