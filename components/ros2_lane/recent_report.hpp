// SPDX-License-Identifier: Apache-2.0
// A sentence for the health that is shown for a while. Pure.
#pragma once

#include <string>
#include <utility>

#include "common/base/time.hpp"

namespace handsel::ros2_lane {

/// Keeps the newest report for ten seconds.
class RecentReport {
 public:
  /// Replaces the report by one made at `now`; an empty one ends it.
  void set(std::string text, TimePoint now) {
    text_ = std::move(text);
    at_ = now;
  }
  /// Returns the report while it is not older than ten seconds, else an empty text.
  std::string current(TimePoint now) const {
    constexpr double kShown = 10;  // [s]
    return to_seconds(now - at_) < kShown ? text_ : std::string();
  }

 private:
  std::string text_;
  TimePoint at_{};
};

}  // namespace handsel::ros2_lane
