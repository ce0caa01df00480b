// How often a piece of work is done: as attention advises, within limits of its own.
#pragma once

#include <algorithm>

#include "common/base/time.hpp"

namespace handsel {

class Pace {
 public:
  /// `fastest`: its period without advice, and the least there is [s] > 0; `slowest` >= fastest: the longest, whatever is advised [s];
  /// `tick`: how often due() is asked [s]: periods are rounded to it.
  Pace(double fastest, double slowest, double tick) : fastest_(fastest), slowest_(std::max(fastest, slowest)), slack_(0.5 * tick) {}

  /// The period that is wanted [s]; 0: as fast as it can be. It holds for `kHeard`; then the fastest again.
  void advise(double period, TimePoint now) {
    advised_ = period;
    advised_at_ = now;
  }
  bool heard(TimePoint now) const { return now - advised_at_ <= kHeard; }  ///< advice that still holds
  double period(TimePoint now) const { return heard(now) ? std::clamp(advised_, fastest_, slowest_) : fastest_; }
  bool due(TimePoint now) const { return !begun_ || to_seconds(now - done_) + slack_ >= period(now); }
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
