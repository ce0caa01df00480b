// SPDX-License-Identifier: Apache-2.0
// Expected effects of the last action before the facts show them. Pure.
#pragma once

#include <optional>

#include "common/base/time.hpp"
#include "components/supervisor/task/htn.hpp"

namespace handsel::supervisor {

/// Assumes the effects of an action that has succeeded until the facts have had time to show them.
class ExpectedEffects {
 public:
  /// `timeout`: time for which effects are assumed [s]. `domain` must outlive this object.
  ExpectedEffects(const Domain& domain, double timeout) : domain_(domain), timeout_(timeout) {}

  /// Notes the end of an action, successful or not.
  void on_end(TimePoint now) { ended_at_ = now; }
  /// Notes that the ended action has succeeded.
  void expect(const PlannedAction& action) { action_ = action; }
  /// Deletes the expected effects.
  void forget() { action_.reset(); }
  /// Returns whether the facts may still lag behind the end of the last action.
  bool pending(TimePoint now) const { return to_seconds(now - ended_at_) < timeout_; }
  /// Returns the state of the world with the expected effects.
  State believed(World& world, TimePoint now) const;

 private:
  const Domain& domain_;
  double timeout_;
  std::optional<PlannedAction> action_;
  TimePoint ended_at_{};
};

}  // namespace handsel::supervisor
