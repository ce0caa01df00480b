// SPDX-License-Identifier: Apache-2.0
// What a visitor of the page may ask for, as JSON: a task or a request, or an action of a simulated
// person. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "common/messages/system.hpp"
#include "common/messages/task.hpp"

namespace handsel::bridge {

/// A task without its id, or an action of a simulated person.
using Command = std::variant<TaskGoal, SimControl>;

struct CommandReading {
  std::optional<Command> command;  ///< nullopt: refused
  std::string refusal;             ///< one sentence for people; empty: not refused
};

/// Reads a command: {"task": KIND, "object": ..., "human": ..., "surface": ..., "onto": ...,
/// "value": ...} or {"person": ID, "action": ACTION, ...}. Refuses every field that the kind or
/// action does not have, and every value out of its range (components/bridge/README.md).
CommandReading read_command(std::string_view json);

}  // namespace handsel::bridge
