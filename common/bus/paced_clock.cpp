#include "common/bus/paced_clock.hpp"

#include <algorithm>

namespace handsel {
namespace {

constexpr Duration kSilence = std::chrono::seconds(1);
constexpr Duration kLook = std::chrono::milliseconds(20);  // while time stands still
constexpr Duration kStale =
    std::chrono::milliseconds(50);  // the simulator repeats a grant more often

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
    // Time in which this component got no processor is not the simulator's silence.
    silence_ += std::clamp(wall - listened_, Duration::zero(), 2 * kLook);
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

/// While time stood still it was where the grant before had ended, not where the machine's clock
/// less all that was waited would be.
TimePoint PacedClock::past(TimePoint wall) const {
  return std::min(std::max(unbounded(wall), std::min(wall - waited_before_, until_before_)), last_);
}

bool PacedClock::stale(TimePoint wall) const { return paced_ && unbounded(wall) > until_ + kStale; }

TimePoint PacedClock::look_at(TimePoint instant, TimePoint wall) const {
  const TimePoint there = instant + waited_;
  return paced_ && instant > until_ ? wall + kLook : there;
}

}  // namespace handsel
