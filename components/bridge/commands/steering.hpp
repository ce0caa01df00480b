// SPDX-License-Identifier: Apache-2.0
// Publishes the commands of visitors of the page: tasks as `handsel task` sends them, and actions
// of simulated people. Publishes nothing else.
#pragma once

#include <memory>

#include "common/bus/bus.hpp"
#include "components/bridge/commands/command_queue.hpp"

namespace handsel::bridge {

class Steering {
 public:
  /// Creates the writers; `bus` must outlive this.
  explicit Steering(Bus& bus);

  /// Sets in the queue who is there, and publishes what waits in it.
  void run(CommandQueue& queue);

 private:
  std::unique_ptr<Publisher<TaskGoal>> tasks_;
  std::unique_ptr<Publisher<SimControl>> people_;
};

}  // namespace handsel::bridge
