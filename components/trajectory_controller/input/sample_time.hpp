// SPDX-License-Identifier: Apache-2.0
// When the newest sample of an input was taken. Pure.
#pragma once

#include <algorithm>

#include "common/base/time.hpp"

namespace handsel::trajectory_controller {

/// Time of the newest sample of one input; it never goes back.
class SampleTime {
 public:
  /// Notes a sample taken at `at`.
  void mark(TimePoint at) noexcept {
    at_ = received_ ? std::max(at_, at) : at;
    received_ = true;
  }
  /// Returns whether any sample was received.
  bool received() const noexcept { return received_; }
  /// Returns how long before `now` the newest sample was taken, at least 0; -1 before any [s].
  double age(TimePoint now) const noexcept {
    return received_ ? std::max(0.0, to_seconds(now - at_)) : -1.0;
  }
  /// Returns how long after the newest sample `at` is; negative when before, 0 before any [s].
  double since(TimePoint at) const noexcept { return received_ ? to_seconds(at - at_) : 0.0; }

 private:
  TimePoint at_{};
  bool received_{};
};

}  // namespace handsel::trajectory_controller
