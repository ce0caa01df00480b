// What must hold for a behaviour to act, as data: one condition a line, all of them together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/attention/schema.hpp"

namespace handsel::attention {

/// "action give", "holding", "fact in_interaction_zone" (of the person of interest's kind: about anybody), "behaviour track"; "not" before
/// one turns it round.
struct Condition {
  enum class Kind { action, holding, fact, behaviour };
  Kind kind{};
  bool negated{};
  ActionKind action{};
  FactKind fact{};
  std::string behaviour;  ///< that must be released
};

/// Throws ConfigError with what is wrong with the text.
Condition parse_condition(const std::string& text);
/// `released`: of the behaviour the condition names, if it names one.
bool met(const Condition& condition, const World& world, bool released);

struct Releaser {
  std::string behaviour;  ///< whose it is
  std::vector<Condition> conditions;
};

/// An order in which each behaviour comes after those its conditions name. Throws ConfigError that tells a cycle, or who is unknown.
std::vector<std::size_t> releaser_order(const std::vector<Releaser>& releasers);

}  // namespace handsel::attention
