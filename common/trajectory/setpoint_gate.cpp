// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/setpoint_gate.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/stop.hpp"

namespace handsel {
namespace {

constexpr double kTolerance = 1e-6;  // relative tolerance of every limit
constexpr double kRounding =
    1e-12;  // of positions [rad], velocities [rad/s] and accelerations [rad/s^2]

using Reason = SetpointRefusal::Reason;

}  // namespace

std::string_view name(SetpointRefusal::Reason reason) {
  switch (reason) {
    case Reason::none:
      return "none";
    case Reason::not_finite:
      return "finite number";
    case Reason::position:
      return "position";
    case Reason::velocity:
      return "velocity";
    case Reason::acceleration:
      return "acceleration";
    case Reason::jerk:
      return "jerk";
    case Reason::velocity_step:
      return "velocity step";
    case Reason::position_step:
      return "position step";
    case Reason::order:
      return "sequence number";
    case Reason::gap:
      return "gap";
    case Reason::early:
      return "time ahead";
  }
  return "unknown";
}

SetpointGate::SetpointGate(const KinematicLimits& limits, const Eigen::VectorXd& lower,
                           const Eigen::VectorXd& upper, const SetpointGateSettings& settings)
    : limits_(limits), lower_(lower), upper_(upper), settings_(settings) {
  previous_.position = previous_.velocity = previous_.acceleration =
      Eigen::VectorXd::Zero(limits.velocity.size());
}

double SetpointGate::margin(Eigen::Index axis) const noexcept {
  return kTolerance * std::max({1.0, std::abs(lower_[axis]), std::abs(upper_[axis])});
}

bool SetpointGate::stops_within_bounds(const AxisState& s, Eigen::Index axis,
                                       const AxisLimits& limits) const noexcept {
  if (lower_[axis] >= upper_[axis]) return true;
  AxisProfile stop;
  critical_movement({s.velocity, s.acceleration}, {}, limits.acceleration, limits.jerk, stop);
  const AxisExtremes reach = extremes(s, stop.segments.data(), stop.count);
  return reach.lowest >= lower_[axis] - margin(axis) &&
         reach.highest <= upper_[axis] + margin(axis);
}

SetpointRefusal SetpointGate::check_state(const AxisState& s, Eigen::Index axis) const noexcept {
  if (!std::isfinite(s.position) || !std::isfinite(s.velocity) || !std::isfinite(s.acceleration))
    return {Reason::not_finite, axis, 0, 0};
  const double room = 1 + kTolerance;
  if (std::abs(s.velocity) > limits_.velocity[axis] * room)
    return {Reason::velocity, axis, s.velocity, limits_.velocity[axis]};
  if (std::abs(s.acceleration) > limits_.acceleration[axis] * room)
    return {Reason::acceleration, axis, s.acceleration, limits_.acceleration[axis]};
  const double peak =
      s.velocity + s.acceleration * std::abs(s.acceleration) / (2 * limits_.jerk[axis]);
  if (std::abs(peak) > limits_.velocity[axis] * room)
    return {Reason::velocity, axis, peak, limits_.velocity[axis]};
  const double lower = lower_[axis], upper = upper_[axis];
  if (lower >= upper) return {};
  if (s.position < lower - margin(axis)) return {Reason::position, axis, s.position, lower};
  if (s.position > upper + margin(axis)) return {Reason::position, axis, s.position, upper};
  const bool moves = s.velocity != 0 || s.acceleration != 0;
  if (!moves || stops_within_bounds(s, axis, limits_of(limits_, axis))) return {};
  const double after = s.position + measure_stop(s.velocity, s.acceleration,
                                                 limits_.acceleration[axis], limits_.jerk[axis])
                                        .distance;
  return {Reason::position, axis, after, s.velocity < 0 ? lower : upper};
}

SetpointRefusal SetpointGate::check_step(const AxisState& from, const AxisState& to,
                                         Eigen::Index axis, double t) const noexcept {
  const double J = limits_.jerk[axis], room = 1 + kTolerance;
  const double da = std::abs(to.acceleration - from.acceleration);
  if (da > J * t * room + kRounding) return {Reason::jerk, axis, da / t, J};
  const double dv = std::abs(to.velocity - from.velocity - from.acceleration * t),
               dv_bound = J * t * t / 2;
  if (dv > dv_bound * room + kRounding) return {Reason::velocity_step, axis, dv, dv_bound};
  const double dp = std::abs(to.position - from.position - from.velocity * t -
                             from.acceleration * t * t / 2),
               dp_bound = J * t * t * t / 6;
  if (dp > dp_bound * room + kRounding) return {Reason::position_step, axis, dp, dp_bound};
  return {};
}

SetpointRefusal SetpointGate::check(const Eigen::VectorXd& position,
                                    const Eigen::VectorXd& velocity,
                                    const Eigen::VectorXd& acceleration, std::uint64_t sequence,
                                    double now) noexcept {
  double t = settings_.period, ahead = 0;
  if (has_previous_) {
    if (sequence <= sequence_)
      return {Reason::order, -1, static_cast<double>(sequence), static_cast<double>(sequence_)};
    t = settings_.period * static_cast<double>(sequence - sequence_);
    if (t > settings_.max_missing + settings_.period / 2)
      return {Reason::gap, -1, t, settings_.max_missing};
    ahead = std::max(0.0, ahead_ + t - (now - time_));
    if (ahead > settings_.max_ahead + settings_.period / 2)
      return {Reason::early, -1, ahead, settings_.max_ahead};
  }
  for (Eigen::Index i = 0; i < previous_.position.size(); ++i) {
    const AxisState to{position[i], velocity[i], acceleration[i]};
    if (const SetpointRefusal refusal = check_state(to, i)) return refusal;
    const AxisState from = has_previous_ ? AxisState{previous_.position[i], previous_.velocity[i],
                                                     previous_.acceleration[i]}
                                         : AxisState{position[i], 0, 0};
    if (const SetpointRefusal refusal = check_step(from, to, i, t)) return refusal;
  }
  previous_.position = position;
  previous_.velocity = velocity;
  previous_.acceleration = acceleration;
  sequence_ = sequence;
  time_ = now;
  ahead_ = ahead;
  has_previous_ = true;
  return {};
}

}  // namespace handsel
