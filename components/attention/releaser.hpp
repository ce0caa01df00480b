// SPDX-License-Identifier: Apache-2.0
// Conditions of a behaviour's releaser as data, all of which must hold.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/attention/schema.hpp"

namespace handsel::attention {

/// "action give", "holding", "fact in_interaction_zone" (about anybody), "behaviour track"; "not"
/// before a condition negates it.
struct Condition {
  enum class Kind { action, holding, fact, behaviour };
  Kind kind{};            ///< selects the valid field below
  bool negated{};         ///< whether the condition is negated
  ActionKind action{};    ///< action that must be running
  FactKind fact{};        ///< fact that must hold about any person or object
  std::string behaviour;  ///< behaviour that must be released
};

/// Reads one condition. Throws ConfigError that names the error.
Condition parse_condition(const std::string& text);
/// Returns whether the condition holds. `released`: state of the behaviour that the condition
/// names.
bool met(const Condition& condition, const World& world, bool released);

/// Conditions of one behaviour.
struct Releaser {
  std::string behaviour;              ///< name of the behaviour
  std::vector<Condition> conditions;  ///< all must hold
};

/// Returns an order in which each behaviour follows those named by its conditions. Throws
/// ConfigError that names a cycle or an unknown behaviour.
std::vector<std::size_t> releaser_order(const std::vector<Releaser>& releasers);

}  // namespace handsel::attention
