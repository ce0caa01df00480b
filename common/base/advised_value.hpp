// SPDX-License-Identifier: Apache-2.0
// A value that another component advises: it holds for a moment, then the receiver is on its own.
#pragma once

#include <optional>
#include <utility>

#include "common/base/time.hpp"

namespace handsel {

/// The newest advice; it expires after 0.3 s, as that of AdvisedPeriod.
template <class Value>
class AdvisedValue {
 public:
  /// Takes the advice that arrived at `now`.
  void advise(Value value, TimePoint now) {
    value_ = std::move(value);
    advised_at_ = now;
  }
  /// Returns the newest advice; nullopt: none has come, or the newest has expired.
  std::optional<Value> at(TimePoint now) const {
    return value_ && now - advised_at_ <= kHeard ? value_ : std::nullopt;
  }

 private:
  static constexpr Duration kHeard = std::chrono::milliseconds(300);

  std::optional<Value> value_;
  TimePoint advised_at_{};
};

}  // namespace handsel
