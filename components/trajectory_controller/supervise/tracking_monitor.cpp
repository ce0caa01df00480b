// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/tracking_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

bool TrackingMonitor::update(const std::vector<int>& axes, const Eigen::VectorXd& measured,
                             const Eigen::VectorXd& set_point, bool follows, double dt) noexcept {
  double distance = 0.0;
  int farthest = -1;
  for (int axis : axes) {
    const double of_axis = std::abs(measured[axis] - set_point[axis]);
    if (of_axis > distance) farthest = axis;
    distance = std::max(distance, of_axis);
  }
  beyond_for_ = follows && distance > tolerance_ ? beyond_for_ + dt : 0.0;
  const bool error = beyond_for_ > time_;
  if (error) {
    axis_ = farthest;
    distance_ = distance;
  }
  return error;
}

}  // namespace handsel::trajectory_controller
