// A condition that counts only once it has held for some time. Pure.
#pragma once

#include <optional>

#include "common/base/time.hpp"

namespace handsel::supervisor {

/// Time for which a condition has held without a break; facts may flicker.
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
  /// Returns whether the condition held when it was taken last.
  bool holds() const { return since_.has_value(); }
  /// Starts anew.
  void reset() { since_.reset(); }

 private:
  std::optional<TimePoint> since_;
};

}  // namespace handsel::supervisor
