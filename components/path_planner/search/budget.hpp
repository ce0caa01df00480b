// SPDX-License-Identifier: Apache-2.0
// Counts the checks of a problem against its budget, and evaluates the conditions that cancel
// planning.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "common/collision/collision_world.hpp"
#include "components/path_planner/problem.hpp"

namespace handsel::path_planner {

class Budget {
 public:
  Budget(const CollisionWorld& world, std::uint64_t limit, const Hooks& hooks)
      : check_(world),
        hooks_(hooks),
        before_(world.checks()),
        exact_before_(world.exact_checks()),
        limit_(limit) {}

  /// Returns the number of checked states so far, plus the charges.
  std::uint64_t checks() const {
    return check_.checks() - before_ + exact_more_ * (check_.exact_checks() - exact_before_) +
           charged_;
  }
  /// Adds `more` checks for each further state that needs the exact check, in proportion to its
  /// duration.
  void charge_exact(std::uint64_t more) {
    exact_more_ = more;
    exact_before_ = check_.exact_checks();
  }
  /// Adds work equivalent to this number of checks.
  void charge(std::uint64_t checks) { charged_ += checks; }
  /// Returns the number of checks at which the budget is exhausted.
  std::uint64_t limit() const { return limit_; }
  /// Sets the limit, counted from construction.
  void limit(std::uint64_t checks) { limit_ = checks; }
  /// Returns whether the cancel hook or the condition of stop_when() ends planning.
  bool cancelled() const { return (hooks_.cancelled && hooks_.cancelled()) || (stop_ && stop_()); }
  /// Sets a further condition that ends planning; empty: none.
  void stop_when(std::function<bool()> stop) { stop_ = std::move(stop); }
  /// Returns whether the budget is exhausted or planning is cancelled.
  bool exhausted() const { return checks() >= limit_ || cancelled(); }
  /// Returns the hooks that were given; must outlive the budget.
  const Hooks& hooks() const { return hooks_; }

 private:
  const CollisionWorld& check_;
  const Hooks& hooks_;
  std::function<bool()> stop_;
  std::uint64_t before_, exact_before_, limit_, charged_{}, exact_more_{};
};

}  // namespace handsel::path_planner
