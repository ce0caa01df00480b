// SPDX-License-Identifier: Apache-2.0
// A command's access to a running system: a DDS participant, a passive observer, and Ctrl-C as a
// flag.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/bus/dds/dds_bus.hpp"
#include "deploy/handsel/system/observer.hpp"

namespace handsel {

/// Turns SIGINT and SIGTERM into a flag for the life of the process; the second SIGINT ends it at
/// once.
void catch_interrupts();
/// Returns true after SIGINT or SIGTERM; false without catch_interrupts().
bool interrupted();

class Session {
 public:
  /// Throws MissingError when the domain cannot be entered.
  explicit Session(int domain);

  DdsBus& bus() { return bus_; }              ///< of the component "handsel", without health
  Observer& observer() { return observer_; }  ///< on the bus, from construction on
  /// Newest samples, as the observer has them.
  const Snapshot& snapshot() const { return observer_.snapshot(); }
  /// Listens until `done` holds, `limit` has passed or Ctrl-C; true if it held.
  bool wait(Duration limit, const std::function<bool()>& done);
  /// Listens for a while, or until Ctrl-C.
  void listen(Duration time) {
    wait(time, [] { return false; });
  }
  /// Throws MissingError when no health of a component arrives within 1 s.
  void require_system();
  /// Publishes a goal as soon as a supervisor listens; false when none did within 1 s.
  bool send(const TaskGoal& goal);
  /// Publishes a goal to the present subscribers; false when the transport refuses.
  bool publish(const TaskGoal& goal) { return goals_->publish(goal); }
  /// Returns the next id, counted from a random start: ids of two commands hardly collide.
  std::uint64_t new_task_id();

 private:
  int domain_;
  DdsBus bus_;
  Observer observer_;
  std::unique_ptr<Publisher<TaskGoal>> goals_;
  std::uint64_t next_task_;
};

}  // namespace handsel
