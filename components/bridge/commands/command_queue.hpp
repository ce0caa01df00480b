// SPDX-License-Identifier: Apache-2.0
// Commands that the thread of the server has accepted and the thread of the bus will publish.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "components/bridge/commands/command.hpp"

namespace handsel::bridge {

/// Who would carry out commands now.
struct CommandTakers {
  bool supervisor{};  ///< takes tasks
  bool simulator{};   ///< moves simulated people
};

/// Every function may be called from any thread.
class CommandQueue {
 public:
  static constexpr std::size_t kMaxWaiting = 64;  ///< commands not yet taken; more are refused

  /// `first_task`: id of the first task; the others follow, each 256 higher.
  explicit CommandQueue(std::uint64_t first_task) : next_task_(first_task) {}

  enum class Outcome { accepted, nobody_takes_it, too_many };
  struct Receipt {
    Outcome outcome{};     ///< whether the command will be published
    std::uint64_t task{};  ///< id given to a task; 0: none
    std::string refusal;   ///< one sentence for people; empty when accepted
  };
  /// Queues a command, if somebody is there who carries it out.
  Receipt put(Command command);

  /// Returns the waiting commands in the order of their arrival.
  std::vector<Command> take();
  /// Sets who is there; at first nobody is.
  void set_takers(const CommandTakers& takers);

 private:
  std::mutex mutex_;
  std::vector<Command> waiting_;
  CommandTakers takers_;
  std::uint64_t next_task_;
};

}  // namespace handsel::bridge
