// SPDX-License-Identifier: Apache-2.0
// A straight path segment between two nodes: one rest-to-rest profile for all axes.
#pragma once

#include "common/trajectory/min_time.hpp"
#include "common/trajectory/path/smooth.hpp"

namespace handsel::detail {

struct PathSegment {
  struct Knot {
    AxisState state;  ///< of s, at the start of the segment
    double time{};    ///< of the same [s]
    Segment segment;
  };
  struct Zone {
    double begin{};  ///< reached then [s]
    LimitScale scale;
  };
  Eigen::VectorXd from, step;  ///< q(t) = from + step * s(t), s in [0, 1]
  std::vector<Knot> knots;     ///< of s, one a segment
  std::vector<Zone> zones;     ///< none: the limits everywhere
  double duration{};           ///< [s]
  double slowing{};            ///< of the phase before the end without constant velocity [s]
  double starting{};           ///< of the one after the start [s]

  PathSegment(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const KinematicLimits& limits,
              const LimitZones& speeds = {});
  AxisState path_state(double t) const noexcept;
  AxisState state(const AxisState& s, Eigen::Index axis) const noexcept {
    return {from[axis] + step[axis] * s.position, step[axis] * s.velocity,
            step[axis] * s.acceleration};
  }
  /// Adds the segments between two times, jerks of s. What there is no room for is left out; then
  /// `out` is full.
  void part(double begin, double end, AxisProfile& out) const noexcept;
  /// The lowest scales of the limits between two times.
  LimitScale scale(double begin, double end) const noexcept;

 private:
  void add(const AxisProfile& profile);
  bool zoned(const LimitZones& speeds, const AxisLimits& limits);
};

}  // namespace handsel::detail
