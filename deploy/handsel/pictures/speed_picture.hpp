// SPDX-License-Identifier: Apache-2.0
// How fast a robot is along its path, and what the path costs people.
#pragma once

#include <string>
#include <vector>

#include "common/trajectory/trajectory.hpp"
#include "components/trajectory_planner/speed_along.hpp"

namespace handsel {

/// Along a trajectory, at regular times.
struct SpeedCurve {
  std::string title;             ///< above the panel
  std::vector<double> progress;  ///< fraction of the path covered, 0 to 1, by joint-space length
  std::vector<double> cost;      ///< human-aware cost of the configuration, [0, 1]
  std::vector<double> allowed;   ///< fraction of the velocity limits allowed there
  std::vector<double> speed;     ///< largest ratio of an axis's speed to its velocity limit
};

/// `limits`: of velocity, of the trajectory's axes; `axes`: their robot axes; `rest`: all axes.
SpeedCurve speed_curve(const Trajectory& trajectory, const std::vector<int>& axes,
                       const Vector& limits, const Vector& rest,
                       const trajectory_planner::SpeedAlong& people);

/// One panel a curve, as SVG.
std::string speed_picture(const std::vector<SpeedCurve>& curves);

}  // namespace handsel
