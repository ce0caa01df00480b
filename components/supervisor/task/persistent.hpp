// SPDX-License-Identifier: Apache-2.0
// A condition that applies only after it has held for some time. Pure.
#pragma once

#include <optional>

#include "common/base/time.hpp"

namespace handsel::supervisor {

/// The time for which a condition has held without interruption, because facts may alternate.
class Persistent {
 public:
  /// Takes the condition as of `now`. Returns whether it has held for `time` [s].
  bool lasts(bool holds, TimePoint now, double time) {
    if (!holds) {
      since_.reset();
      return false;
    }
    if (!since_) since_ = now;
    return to_seconds(now - *since_) >= time;
  }
  /// Returns the last value of the condition.
  bool holds() const { return since_.has_value(); }
  /// Resets the time.
  void reset() { since_.reset(); }

 private:
  std::optional<TimePoint> since_;
};

}  // namespace handsel::supervisor
