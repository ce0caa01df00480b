// How fast a robot is along its way, and what the way costs people.
#pragma once

#include <string>
#include <vector>

#include "common/trajectory/trajectory.hpp"
#include "components/trajectory_planner/speed_along.hpp"

namespace handsel {

/// Along a trajectory, at regular times.
struct SpeedCurve {
  std::string title;
  std::vector<double> way;      ///< gone so far, 0 to 1, by joint-space length
  std::vector<double> cost;     ///< human-aware, of the posture
  std::vector<double> allowed;  ///< share of the velocity limits there
  std::vector<double> speed;    ///< largest share of an axis's velocity limit in use
};

/// `limits`: of velocity, of the trajectory's axes; `axes`: their robot axes; `rest`: all axes.
SpeedCurve speed_curve(const Trajectory& trajectory, const std::vector<int>& axes, const Vector& limits, const Vector& rest,
                       const trajectory_planner::SpeedAlong& people);

/// One panel a curve, as SVG.
std::string speed_picture(const std::vector<SpeedCurve>& curves);

}  // namespace handsel
