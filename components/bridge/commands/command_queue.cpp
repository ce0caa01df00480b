// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/commands/command_queue.hpp"

#include <utility>

namespace handsel::bridge {

namespace {

constexpr std::uint64_t kTaskStep = 256;  // the low byte of an id names its kind of sender

}  // namespace

CommandQueue::Receipt CommandQueue::put(Command command) {
  const std::lock_guard lock(mutex_);
  auto* task = std::get_if<TaskGoal>(&command);
  if (task != nullptr && !takers_.supervisor)
    return {Outcome::nobody_takes_it, 0, "nobody takes tasks: the supervisor is not there"};
  if (task == nullptr && !takers_.simulator)
    return {Outcome::nobody_takes_it, 0,
            "there are no simulated people: the simulator is not there"};
  if (waiting_.size() >= kMaxWaiting)
    return {Outcome::too_many, 0,
            "more than " + std::to_string(kMaxWaiting) + " commands wait to be sent"};
  Receipt receipt;
  if (task != nullptr) receipt.task = task->id = std::exchange(next_task_, next_task_ + kTaskStep);
  waiting_.push_back(std::move(command));
  return receipt;
}

std::vector<Command> CommandQueue::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, {});
}

void CommandQueue::set_takers(const CommandTakers& takers) {
  const std::lock_guard lock(mutex_);
  takers_ = takers;
}

}  // namespace handsel::bridge
