// SPDX-License-Identifier: Apache-2.0
#include "sim/people/step_in.hpp"

#include <algorithm>
#include <cmath>

#include "sim/people/person_parts.hpp"

namespace handsel::sim {
namespace {

/// A walk of fixed length from rest to rest, with trapezoidal speed.
class Walk {
 public:
  Walk(double length, double speed)
      : length_(length), peak_(std::min(speed, std::sqrt(length * kMaxStepAcceleration))) {}
  double duration() const { return length_ / peak_ + peak_ / kMaxStepAcceleration; }
  double walked(double time) const {
    const double rise = peak_ / kMaxStepAcceleration, t = std::clamp(time, 0.0, duration());
    if (t < rise) return 0.5 * kMaxStepAcceleration * t * t;
    const double left = duration() - t;
    if (left < rise) return length_ - 0.5 * kMaxStepAcceleration * left * left;
    return peak_ * (t - 0.5 * rise);
  }

 private:
  double length_, peak_;
};

}  // namespace

double distance_from_place(const StepInSettings& visit, double from, double time) {
  if (visit.speed <= 0 || from <= 0) return from;
  const Walk walk(from, visit.speed);
  const double t = time - visit.at, back = t - walk.duration() - visit.stays;
  return back < 0 ? from - walk.walked(t) : walk.walked(back);
}

}  // namespace handsel::sim
