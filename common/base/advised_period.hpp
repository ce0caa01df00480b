// SPDX-License-Identifier: Apache-2.0
// Period of a piece of work: as attention advises, within its own limits.
#pragma once

#include <algorithm>

#include "common/base/time.hpp"

namespace handsel {

/// The period of a recurring piece of work, adapted to advice.
class AdvisedPeriod {
 public:
  /// `fastest`: period without advice and lower bound of advice [s], > 0; `slowest` >= `fastest`:
  /// upper bound of advice [s]; `tick`: period at which due() is called [s], to which periods are
  /// rounded.
  AdvisedPeriod(double fastest, double slowest, double tick)
      : fastest_(fastest), slowest_(std::max(fastest, slowest)), slack_(0.5 * tick) {}

  /// Sets the advised period [s]; 0: the fastest. The advice expires after 0.3 s.
  void advise(double period, TimePoint now) {
    advised_ = period;
    advised_at_ = now;
  }
  /// Returns whether the last advice still holds.
  bool is_advised(TimePoint now) const { return now - advised_at_ <= kHeard; }
  /// Returns the period in force [s]: the advised one within [fastest, slowest], else the fastest.
  double period(TimePoint now) const {
    return is_advised(now) ? std::clamp(advised_, fastest_, slowest_) : fastest_;
  }
  /// Returns whether the period has passed since done(), up to half a tick early; true before the
  /// first done().
  bool due(TimePoint now) const {
    return !begun_ || to_seconds(now - done_) + slack_ >= period(now);
  }
  /// Starts the period anew: the work was done at `now`.
  void done(TimePoint now) {
    begun_ = true;
    done_ = now;
  }

 private:
  static constexpr Duration kHeard = std::chrono::milliseconds(300);

  double fastest_, slowest_, slack_;
  double advised_{};
  TimePoint advised_at_{}, done_{};
  bool begun_{};
};

}  // namespace handsel
