// SPDX-License-Identifier: Apache-2.0
#include "sim/oracle/limits_oracle.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {

namespace {

constexpr double kTolerance = 1e-6;  // relative tolerance of a bound
constexpr double kRounding = 1e-12;  // rounding error of positions [rad]
// Max distance of a first set-point from the robot's configuration [rad].
constexpr double kMaxRestartJump = 0.05;
// Numbers of set-points after which the period is estimated, and after which any estimate is used.
constexpr std::size_t kEstimateAfter = 100, kMaxEstimateAfter = 3200;
// Standard control periods [s].
constexpr std::array kPeriods{0.0005, 0.001, 0.002, 0.004, 0.005, 0.008, 0.010, 0.020};

/// Returns the standard period with the largest number of nearby intervals, if these are more than
/// half of all or `any` is set; 0: none. A busy machine omits and delays cycles, which changes the
/// mean but not the majority of the intervals.
double period_of(const std::vector<LimitsOracle::Held>& stream, bool any) {
  std::array<std::size_t, kPeriods.size()> votes{};
  for (std::size_t i = 1; i < stream.size(); ++i) {
    if (!stream[i].continues) continue;
    const double interval =
        (stream[i].time - stream[i - 1].time) /
        static_cast<double>(stream[i].command.sequence - stream[i - 1].command.sequence);
    for (std::size_t k = 0; k < kPeriods.size(); ++k)
      votes[k] += std::abs(interval - kPeriods[k]) < 0.1 * kPeriods[k];
  }
  const auto best = std::max_element(votes.begin(), votes.end());
  if (*best == 0 || (!any && 2 * *best < stream.size())) return 0;
  return kPeriods[static_cast<std::size_t>(best - votes.begin())];
}

}  // namespace

LimitsOracle::LimitsOracle(const RobotModel& model, double restart_after, double period)
    : model_(model),
      limits_(model.guard_limits()),
      restart_after_(restart_after),
      period_(period) {}

void LimitsOracle::violated(const char* what, Eigen::Index axis, double value, double bound) {
  bad_ = true;
  if (first_.empty())
    first_ = std::string(what) + " of " + model_.axes()[axis].name + ": " + std::to_string(value) +
             " beyond " + std::to_string(bound);
}

void LimitsOracle::check_bounds(const JointCommand& c) {
  for (Eigen::Index i = 0; i < c.position.size(); ++i) {
    const double v = std::abs(c.velocity[i]), a = std::abs(c.acceleration[i]);
    ratios_[0] = std::max(ratios_[0], v / limits_.velocity[i]);
    ratios_[1] = std::max(ratios_[1], a / limits_.acceleration[i]);
    if (v > limits_.velocity[i] * (1 + kTolerance)) violated("velocity", i, v, limits_.velocity[i]);
    if (a > limits_.acceleration[i] * (1 + kTolerance))
      violated("acceleration", i, a, limits_.acceleration[i]);
    const Axis& axis = model_.axes()[i];
    if (axis.lower < axis.upper &&
        (c.position[i] < axis.lower - kTolerance || c.position[i] > axis.upper + kTolerance)) {
      violated("position", i, c.position[i], c.position[i] < axis.lower ? axis.lower : axis.upper);
    }
  }
}

double LimitsOracle::between(const JointCommand& from, const JointCommand& to) const {
  return period_ * static_cast<double>(to.sequence - from.sequence);
}

void LimitsOracle::check_step(const JointCommand& from, const JointCommand& to, double t) {
  for (Eigen::Index i = 0; i < to.position.size(); ++i) {
    const double J = limits_.jerk[i];
    const double da = std::abs(to.acceleration[i] - from.acceleration[i]);
    const double dv = std::abs(to.velocity[i] - from.velocity[i] - from.acceleration[i] * t);
    const double dp = std::abs(to.position[i] - from.position[i] - from.velocity[i] * t -
                               from.acceleration[i] * t * t / 2);
    const double ratio = std::max(da / (J * t), dv / (J * t * t / 2));
    ratios_[2] = std::max(ratios_[2], ratio);
    if (ratio > 1 + kTolerance) violated("jerk", i, ratio * J, J);
    const double max_step = J * t * t * t / 6 * (1 + kTolerance) + kRounding;
    if (dp > max_step) violated("position step", i, dp, max_step);
  }
}

void LimitsOracle::check_change(const JointCommand& from, const JointCommand& to, double T) {
  for (Eigen::Index i = 0; i < to.position.size(); ++i) {
    const double J = limits_.jerk[i], v0 = from.velocity[i], a0 = from.acceleration[i];
    const double da = std::abs(to.acceleration[i] - a0);
    if (da > J * T * (1 + kTolerance)) violated("jerk at a change", i, da / T, J);
    const double dv = to.velocity[i] - v0, dv_tolerance = J * T * T / 2 * (1 + kTolerance);
    if (dv < std::min(0.0, a0 * T) - dv_tolerance || dv > std::max(0.0, a0 * T) + dv_tolerance)
      violated("velocity step at a change", i, dv, std::abs(a0) * T + dv_tolerance);
    const auto moved = [&](double t) { return v0 * t + a0 * t * t / 2; };
    const double turn = a0 != 0 ? std::clamp(-v0 / a0, 0.0, T) : 0.0;
    const auto [min_moved, max_moved] = std::minmax({0.0, moved(turn), moved(T)});
    const double dp = to.position[i] - from.position[i],
                 dp_tolerance = J * T * T * T / 6 * (1 + kTolerance) + kRounding;
    if (dp < min_moved - dp_tolerance || dp > max_moved + dp_tolerance)
      violated("position step at a change", i, dp, max_moved + dp_tolerance);
  }
}

void LimitsOracle::observe(const JointCommand& command, std::uint64_t writer, double now,
                           const Vector& actual, const Vector& held) {
  if (command.position.size() != actual.size() || command.velocity.size() != actual.size() ||
      command.acceleration.size() != actual.size()) {
    return;
  }
  bad_ = false;
  const bool first = count_ == 0;
  const double gap = now - last_time_;
  if (!first) max_gap_ = std::max(max_gap_, gap);
  const bool starts = first || gap > restart_after_;
  const bool continues = !starts && writer == last_writer_ && command.sequence > previous_.sequence;
  writers_.insert(writer);
  ++count_;
  check_bounds(command);
  if (starts) {
    for (Eigen::Index i = 0; i < actual.size(); ++i) {
      const double at = command.position[i];
      const double jump = std::min(std::abs(at - actual[i]), std::abs(at - held[i]));
      if (jump > kMaxRestartJump) violated("jump at a new start", i, jump, kMaxRestartJump);
    }
  } else if (!continues) {
    check_change(previous_, command,
                 std::max(0.0, gap) + (period_ > 0 ? period_ : kPeriods.back()));
  }
  if (period_ > 0) {
    if (continues) check_step(previous_, command, between(previous_, command));
  } else {
    if (starts) waiting_.clear();
    waiting_.push_back(
        {command, command.stamp != 0 ? static_cast<double>(command.stamp) * 1e-9 : now, continues});
    if (waiting_.size() % kEstimateAfter == 0)
      period_ = period_of(waiting_, waiting_.size() >= kMaxEstimateAfter);
    if (period_ > 0) {
      for (std::size_t i = 1; i < waiting_.size(); ++i)
        if (waiting_[i].continues)
          check_step(waiting_[i - 1].command, waiting_[i].command,
                     between(waiting_[i - 1].command, waiting_[i].command));
      waiting_.clear();
      waiting_.shrink_to_fit();
    }
  }
  if (bad_) ++violations_;
  previous_ = command;
  last_writer_ = writer;
  last_time_ = now;
}

}  // namespace handsel::sim
