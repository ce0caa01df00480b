// SPDX-License-Identifier: Apache-2.0
#include "sim/people/step_in.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {
namespace {

/// A walk of fixed length from rest to rest, with trapezoidal speed.
class Walk {
 public:
  Walk(double length, double speed, double acceleration)
      : length_(length),
        acceleration_(acceleration),
        peak_(std::min(speed, std::sqrt(length * acceleration))) {}
  double duration() const { return length_ / peak_ + peak_ / acceleration_; }
  double walked(double time) const {
    const double rise = peak_ / acceleration_, t = std::clamp(time, 0.0, duration());
    if (t < rise) return 0.5 * acceleration_ * t * t;
    const double left = duration() - t;
    if (left < rise) return length_ - 0.5 * acceleration_ * left * left;
    return peak_ * (t - 0.5 * rise);
  }

 private:
  double length_, acceleration_, peak_;
};

}  // namespace

double distance_from_place(const StepInSettings& visit, double from, double time,
                           double acceleration) {
  if (visit.speed <= 0 || from <= 0) return from;
  const Walk walk(from, visit.speed, acceleration);
  const double t = time - visit.at, back = t - walk.duration() - visit.stays;
  return back < 0 ? from - walk.walked(t) : walk.walked(back);
}

}  // namespace handsel::sim
