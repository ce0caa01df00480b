// SPDX-License-Identifier: Apache-2.0
// Limit of how many messages one sender may send in a second. Pure.
#pragma once

#include "common/base/time.hpp"

namespace handsel::bridge {

class RateLimit {
 public:
  explicit RateLimit(unsigned max_per_second) : max_(max_per_second) {}

  /// Counts a message at `now`; returns false if it is one too many.
  bool admit(TimePoint now) {
    if (now - begin_ > std::chrono::seconds(1)) {
      begin_ = now;
      count_ = 0;
    }
    return ++count_ <= max_;
  }

 private:
  unsigned max_, count_{0};  // count since begin_
  TimePoint begin_{};
};

}  // namespace handsel::bridge
