// What must hold for a behaviour to act, as data: one condition a line, all of them together.
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
  Kind kind{};            ///< which of the fields below counts
  bool negated{};         ///< true: the opposite must hold
  ActionKind action{};    ///< that must be running
  FactKind fact{};        ///< that must hold about anybody or anything
  std::string behaviour;  ///< that must be released
};

/// Reads one condition. Throws ConfigError with what is wrong with the text.
Condition parse_condition(const std::string& text);
/// `released`: of the behaviour the condition names, if it names one.
bool met(const Condition& condition, const World& world, bool released);

/// Conditions of one behaviour.
struct Releaser {
  std::string behaviour;              ///< whose it is
  std::vector<Condition> conditions;  ///< all must hold
};

/// An order in which each behaviour comes after those its conditions name. Throws ConfigError
/// naming a cycle or an unknown behaviour.
std::vector<std::size_t> releaser_order(const std::vector<Releaser>& releasers);

}  // namespace handsel::attention
