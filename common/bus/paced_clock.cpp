// SPDX-License-Identifier: Apache-2.0
#include "common/bus/paced_clock.hpp"

#include <algorithm>

namespace handsel {
namespace {

constexpr Duration kSilence = std::chrono::seconds(1);
constexpr Duration kCheckInterval = std::chrono::milliseconds(20);  // while time is at rest
constexpr Duration kStale =
    std::chrono::milliseconds(50);  // the simulator repeats grants more often

}  // namespace

bool PacedClock::grant(const TimeGrant& grant, TimePoint wall) {
  if (paced_ && grant.incarnation != incarnation_) return false;
  if (ever_paced_)
    at(wall);
  else
    last_ = wall - grant.waited;
  if (ever_paced_) {
    until_before_ = until_;
    waited_before_ = waited_;
  }
  paced_ = ever_paced_ = true;
  incarnation_ = grant.incarnation;
  until_ = grant.until;
  waited_ = grant.waited;
  silence_ = Duration::zero();
  listened_ = wall;
  return true;
}

TimePoint PacedClock::at(TimePoint wall) {
  if (paced_) {
    // Time without a processor for this component is not silence of the simulator.
    silence_ += std::clamp(wall - listened_, Duration::zero(), 2 * kCheckInterval);
    listened_ = std::max(listened_, wall);
    if (silence_ > kSilence) {
      paced_ = false;
      waited_ = wall - last_;
    }
  }
  if (stale(wall)) return last_;
  last_ = std::max(last_, paced_ ? std::min(unbounded(wall), until_) : unbounded(wall));
  return last_;
}

/// Returns the time of a past instant: while time was at rest, the end of the previous grant, which
/// is not the machine's clock minus the time waited.
TimePoint PacedClock::past(TimePoint wall) const {
  return std::min(std::max(unbounded(wall), std::min(wall - waited_before_, until_before_)), last_);
}

bool PacedClock::stale(TimePoint wall) const { return paced_ && unbounded(wall) > until_ + kStale; }

TimePoint PacedClock::look_at(TimePoint instant, TimePoint wall) const {
  const TimePoint there = instant + waited_;
  return paced_ && instant > until_ ? wall + kCheckInterval : there;
}

}  // namespace handsel
