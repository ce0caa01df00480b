// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/three_segment.hpp"

#include <algorithm>

#include "common/trajectory/limits_check.hpp"

namespace handsel {

std::array<Segment, 3> three_segment(const AxisState& from, const AxisState& to,
                                     double T) noexcept {
  const double a = (to.acceleration - from.acceleration) / T;
  const double b = (to.velocity - from.velocity - from.acceleration * T) / (T * T);
  const double c =
      (to.position - from.position - T * (from.velocity + from.acceleration * T / 2)) / (T * T * T);
  return {{{T / 3, a - 9 * b + 27 * c},
           {T / 3, -3.5 * a + 27 * b - 54 * c},
           {T / 3, 5.5 * a - 18 * b + 27 * c}}};
}

double excess(const AxisState& from, const Segment* segments, int count,
              const AxisLimits& limits) noexcept {
  const AxisExtremes e = rate_extremes(from, segments, count);
  return std::max({e.velocity / limits.velocity, e.acceleration / limits.acceleration,
                   e.jerk / limits.jerk}) -
         1;
}

}  // namespace handsel
