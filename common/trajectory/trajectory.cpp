// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/trajectory.hpp"

#include <algorithm>

#include "common/trajectory/min_time.hpp"

namespace handsel {

double Trajectory::duration() const {
  double max_duration = 0;
  for (const AxisTrajectory& axis : axes) {
    double sum = 0;
    for (const Segment& s : axis.segments) sum += s.duration;
    max_duration = std::max(max_duration, sum);
  }
  return max_duration;
}

void Trajectory::sample(double t, MotionState3& out) const noexcept {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    AxisState s = axes[i].start;
    double left = std::max(0.0, t);
    for (const Segment& segment : axes[i].segments) {
      const double step = std::min(left, segment.duration);
      s = advanced(s, step, segment.jerk);
      left -= step;
      if (!(left > 0)) break;
    }
    const auto k = static_cast<Eigen::Index>(i);
    out.position[k] = s.position;
    out.velocity[k] = s.velocity;
    out.acceleration[k] = s.acceleration;
  }
}

MotionState3 Trajectory::at(double t) const {
  MotionState3 out;
  out.position.resize(size());
  out.velocity.resize(size());
  out.acceleration.resize(size());
  sample(t, out);
  return out;
}

}  // namespace handsel
