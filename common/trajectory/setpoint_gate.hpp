// SPDX-License-Identifier: Apache-2.0
// The robot side's own check of every set-point of any sender: bounds, and finite differences
// against the set-point followed before. Pure, no heap after construction.
#pragma once

#include <cstdint>
#include <string_view>

#include "common/trajectory/min_time.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

struct SetpointGateSettings {
  double period{0.001};     ///< of the sender; sequence numbers count in it [s]
  double max_ahead{0.020};  ///< longest time a set-point may come before its own [s]
  double max_missing{0.1};  ///< longest time that missing set-points may stand for [s]
};

/// Why a set-point was refused.
struct SetpointRefusal {
  enum class Reason : std::uint8_t {
    none,
    not_finite,
    position,       ///< outside the bounds, or no stop ends within them
    velocity,       ///< beyond the limit, or about to be whatever the jerk
    acceleration,   ///< beyond the limit
    jerk,           ///< the acceleration changes faster than the limit lets it
    velocity_step,  ///< the velocity changes otherwise than the accelerations say
    position_step,  ///< the position changes otherwise than the velocities say
    order,          ///< its number is not greater than the one before
    gap,            ///< more numbers are missing than max_missing has periods
    early           ///< it is further ahead of its time than max_ahead
  };
  Reason reason{Reason::none};  ///< first check that failed; none: accepted
  Eigen::Index axis{-1};        ///< -1: not of one axis
  /// In the unit of the reason; numbers and times where it is not of one axis.
  double value{}, bound{};
  explicit operator bool() const { return reason != Reason::none; }
};
/// "position", "velocity", ...; for sentences.
std::string_view name(SetpointRefusal::Reason reason);

/// With t = n periods between two set-points numbered n apart and |jerk| <= J: |a1 - a0| <= J t,
/// |v1 - v0 - a0 t| <= J t^2/2 and |p1 - p0 - v0 t - a0 t^2/2| <= J t^3/6; |v| <= V, |a| <= A and
/// lower <= p <= upper at each, and so they stay while a minimum-time stop follows. All limits may
/// be exceeded by 1e-6 of them.
class SetpointGate {
 public:
  /// Axes with lower >= upper have no bounds.
  SetpointGate(const KinematicLimits& limits, const Eigen::VectorXd& lower,
               const Eigen::VectorXd& upper, const SetpointGateSettings& settings);

  /// The next set-point is the first: it must continue from rest at its own position. Whether that
  /// position may be followed is the caller's.
  void restart() { has_previous_ = false; }
  /// Checks a set-point that arrived at `now` [s], by a clock that never stops; one that is
  /// not refused becomes the one the next is checked against. The vectors have as many elements as
  /// there are axes.
  SetpointRefusal check(const Eigen::VectorXd& position, const Eigen::VectorXd& velocity,
                        const Eigen::VectorXd& acceleration, std::uint64_t sequence,
                        double now) noexcept;
  /// Checks one state by itself: is it within the limits and bounds, and can it be stopped within
  /// them?
  SetpointRefusal check_state(const AxisState& s, Eigen::Index axis) const noexcept;
  /// Whether a stop from this state with these limits stays within the bounds.
  bool stops_within_bounds(const AxisState& s, Eigen::Index axis,
                           const AxisLimits& limits) const noexcept;
  /// Returns the limits given at construction.
  const KinematicLimits& limits() const { return limits_; }

 private:
  double margin(Eigen::Index axis) const noexcept;
  SetpointRefusal check_step(const AxisState& from, const AxisState& to, Eigen::Index axis,
                             double t) const noexcept;

  KinematicLimits limits_;
  Eigen::VectorXd lower_, upper_;
  SetpointGateSettings settings_;
  MotionState3 previous_;
  std::uint64_t sequence_{};
  double time_{}, ahead_{};
  bool has_previous_{false};
};

}  // namespace handsel
