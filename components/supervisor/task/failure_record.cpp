// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/failure_record.hpp"

#include <algorithm>

#include "common/messages/names.hpp"

namespace handsel::supervisor {

using Rule = settings::FailureRule;

static_assert(static_cast<int>(ActionFailure::cancelled) ==
              static_cast<int>(Rule::Failure::cancelled));

const settings::FailureRule* FailureRecord::rule(ActionKind kind, ActionFailure failure) const {
  const auto& rules = settings_.failures;
  const auto found = std::find_if(rules.begin(), rules.end(), [&](const settings::FailureRule& r) {
    const bool of_failure =
        r.failure == Rule::Failure::any || static_cast<int>(r.failure) == static_cast<int>(failure);
    return of_failure && (r.kind.empty() || r.kind == name(kind));
  });
  return found != rules.end() ? &*found : nullptr;
}

bool FailureRecord::retry(const settings::FailureRule* rule, const std::string& action) {
  if (rule == nullptr || rule->then != Rule::Answer::again) return false;
  std::uint32_t& tries = tries_[action];
  if (tries >= rule->tries) return false;
  ++tries;
  return true;
}

void FailureRecord::note(const std::string& action, const std::string& reason) {
  if (first_.empty()) first_ = action + ": " + reason;
}

void FailureRecord::give_up(const std::string& reason) {
  given_up_ = reason;
  tries_.clear();
}

}  // namespace handsel::supervisor
