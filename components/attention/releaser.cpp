// SPDX-License-Identifier: Apache-2.0
#include "components/attention/releaser.hpp"

#include <algorithm>
#include <span>
#include <sstream>

#include "common/base/errors.hpp"
#include "common/messages/names.hpp"
#include "components/attention/looks.hpp"

namespace handsel::attention {
namespace {

template <class E>
E named(const std::string& what, const std::string& word, std::span<const char* const> names) {
  const auto at = std::find(names.begin(), names.end(), word);
  if (at == names.end()) throw ConfigError("\"" + word + "\" is no " + what);
  return static_cast<E>(at - names.begin());
}

enum class Mark { unseen, open, closed };

void visit(std::size_t index, const std::vector<Releaser>& releasers, std::vector<Mark>& marks,
           std::vector<std::size_t>& path, std::vector<std::size_t>& order) {
  if (marks[index] == Mark::closed) return;
  path.push_back(index);
  if (marks[index] == Mark::open) {
    std::string chain;
    for (auto at = std::find(path.begin(), path.end(), index); at != path.end(); ++at)
      chain += (chain.empty() ? "" : " -> ") + releasers[*at].behaviour;
    throw ConfigError("releasers wait for each other: " + chain);
  }
  marks[index] = Mark::open;
  for (const Condition& condition : releasers[index].conditions) {
    if (condition.kind != Condition::Kind::behaviour) continue;
    const auto at = std::find_if(releasers.begin(), releasers.end(), [&](const Releaser& r) {
      return r.behaviour == condition.behaviour;
    });
    if (at == releasers.end())
      throw ConfigError("behaviour " + releasers[index].behaviour + " waits for \"" +
                        condition.behaviour + "\", which is not described");
    visit(static_cast<std::size_t>(at - releasers.begin()), releasers, marks, path, order);
  }
  marks[index] = Mark::closed;
  path.pop_back();
  order.push_back(index);
}

}  // namespace

Condition parse_condition(const std::string& text) {
  std::istringstream in(text);
  std::string word, subject, rest;
  Condition condition;
  in >> word;
  if (word == "not") {
    condition.negated = true;
    in >> word;
  }
  in >> subject >> rest;
  if (word == "holding" && subject.empty()) {
    condition.kind = Condition::Kind::holding;
  } else if (word == "action" && rest.empty()) {
    condition.kind = Condition::Kind::action;
    condition.action = named<ActionKind>("action", subject, kActionKindNames);
  } else if (word == "fact" && rest.empty()) {
    condition.kind = Condition::Kind::fact;
    condition.fact = named<FactKind>("fact", subject, kFactNames);
  } else if (word == "behaviour" && !subject.empty() && rest.empty()) {
    condition.kind = Condition::Kind::behaviour;
    condition.behaviour = subject;
  } else {
    throw ConfigError("\"" + text +
                      "\" is none of: holding, action KIND, fact NAME, behaviour NAME, each with "
                      "or without \"not\" before it");
  }
  return condition;
}

bool met(const Condition& condition, const World& world, bool released) {
  bool holds_now = released;
  if (condition.kind == Condition::Kind::action) holds_now = doing(world, condition.action);
  if (condition.kind == Condition::Kind::holding) holds_now = world.action && world.action->holding;
  if (condition.kind == Condition::Kind::fact) holds_now = holds(world, condition.fact, "");
  return holds_now != condition.negated;
}

std::vector<std::size_t> releaser_order(const std::vector<Releaser>& releasers) {
  std::vector<Mark> marks(releasers.size(), Mark::unseen);
  std::vector<std::size_t> path, order;
  for (std::size_t i = 0; i < releasers.size(); ++i) visit(i, releasers, marks, path, order);
  return order;
}

}  // namespace handsel::attention
