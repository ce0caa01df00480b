// A straight leg between two nodes: one rest-to-rest profile for all axes.
#pragma once

#include "common/trajectory/min_time.hpp"

namespace handsel::detail {

struct Leg {
  Eigen::VectorXd from, step;   ///< q(t) = from + step * s(t), s in [0, 1]
  AxisProfile profile;          ///< of s
  std::array<AxisState, 8> at;  ///< of s at the start of each segment
  std::array<double, 8> knot;   ///< [s]
  double duration{};            ///< [s]
  double slowing{};             ///< of the phase before the end, and after the start, without constant velocity [s]

  Leg(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const KinematicLimits& limits);
  AxisState path_state(double t) const noexcept;
  AxisState state(const AxisState& s, Eigen::Index axis) const noexcept {
    return {from[axis] + step[axis] * s.position, step[axis] * s.velocity, step[axis] * s.acceleration};
  }
  /// Adds the segments between two times, jerks of s.
  void part(double begin, double end, AxisProfile& out) const noexcept;
};

}  // namespace handsel::detail
