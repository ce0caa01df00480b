// SPDX-License-Identifier: Apache-2.0
// Why a component last refused to send a message, for its health. Pure: the caller brings the time.
#pragma once

#include <optional>
#include <string>

#include "common/base/time.hpp"

namespace handsel {

class SendRefusal {
 public:
  /// Notes a refusal at `now`. Returns whether to log the reason: none was shown at that time.
  bool note(const std::string& reason, TimePoint now) {
    const bool first = text(now).empty();
    reason_ = "refused to send: " + reason;
    at_ = now;
    return first;
  }
  /// Returns the last refusal, or nothing when it was over ten seconds ago.
  std::string text(TimePoint now) const {
    constexpr double kShown = 10.0;  // [s]
    return at_ && to_seconds(now - *at_) < kShown ? reason_ : std::string();
  }

 private:
  std::string reason_;
  std::optional<TimePoint> at_;
};

}  // namespace handsel
