// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/commands/steering.hpp"

namespace handsel::bridge {

Steering::Steering(Bus& bus)
    : tasks_(bus.advertise<TaskGoal>()), people_(bus.advertise<SimControl>()) {}

void Steering::run(CommandQueue& queue) {
  // Supervisor and SPARK both read the goals.
  queue.set_takers({.supervisor = tasks_->readers() > 1, .simulator = people_->readers() > 0});
  for (const Command& command : queue.take()) {
    if (const auto* task = std::get_if<TaskGoal>(&command))
      tasks_->publish(*task);
    else
      people_->publish(std::get<SimControl>(command));
  }
}

}  // namespace handsel::bridge
