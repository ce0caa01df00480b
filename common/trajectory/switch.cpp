// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/switch.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"

namespace handsel {

namespace {
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-6;
constexpr double kMinDuration = 1e-13;  // min duration of a segment [s]
constexpr double kRounding = 1e-11;     // [rad], [rad/s], [rad/s^2]
}  // namespace

const char* reason(SwitchOutcome outcome) noexcept {
  switch (outcome) {
    case SwitchOutcome::ok:
      return "";
    case SwitchOutcome::wrong_size:
      return "the new trajectory does not have the axes of the present motion";
    case SwitchOutcome::not_finite:
      return "a number of the present state is not finite";
    case SwitchOutcome::bad_limits:
      return "a limit is not positive";
    case SwitchOutcome::start_beyond_limits:
      return "the present state is beyond the limits";
    case SwitchOutcome::nowhere:
      return "nowhere in the time allowed can the new trajectory be joined inside the limits";
    case SwitchOutcome::too_long:
      return "the new trajectory has more segments than there is room for";
    case SwitchOutcome::not_now:
      return "the speed along the path is changing too fast to switch at this moment";
  }
  return "";
}

bool same_motion(const MotionState3& a, const MotionState3& b) noexcept {
  const auto same = [](const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
    return ((x - y).array().abs() <= kRounding).all();
  };
  return same(a.position, b.position) && same(a.velocity, b.velocity) &&
         same(a.acceleration, b.acceleration);
}

TrajectorySwitch::TrajectorySwitch(int axes)
    : n_(axes),
      problems_(axes),
      profiles_(axes),
      start_(axes),
      there_(rest_state(Eigen::VectorXd::Zero(axes))),
      at_(axes),
      left_(axes) {
  jerk_ = Eigen::VectorXd::Zero(axes);
  reduced_ = {jerk_, jerk_, jerk_};
}

double TrajectorySwitch::meeting(const MotionState3& now, const SegmentTable& next,
                                 const KinematicLimits& limits, double t,
                                 double min_duration) noexcept {
  next.evaluate(t, cursor_, there_);
  if (min_duration == 0 && same_motion(now, there_)) return 0;
  double common = min_duration;
  for (int i = 0; i < n_; ++i) {
    const AxisState from{now.position[i], now.velocity[i], now.acceleration[i]};
    const AxisState to{there_.position[i], there_.velocity[i], there_.acceleration[i]};
    if (problems_[i].init(from, to, limits_of(limits, i)) != AxisOutcome::ok) return kNever;
    common = std::max(common, problems_[i].minimum());
  }
  for (bool grown = true; grown;) {
    grown = false;
    for (int i = 0; i < n_; ++i) {
      const double later = problems_[i].earliest(common);
      if (later > common) common = later, grown = true;
    }
  }
  return common;
}

bool TrajectorySwitch::best_place(const MotionState3& now, const SegmentTable& next,
                                  const KinematicLimits& limits,
                                  const SwitchSettings& settings) noexcept {
  const double first = std::clamp(settings.first, 0.0, next.duration()),
               last = std::clamp(settings.last, first, next.duration());
  const int tries = std::max(2, settings.tries);
  const double spacing = (last - first) / (tries - 1);
  double best = kNever;
  const auto evaluate = [&](double t) {
    const double total = meeting(now, next, limits, t, 0) - t;
    if (total < best - 1e-12) best = total, join_ = t;
  };
  for (int k = 0; k < tries; ++k) evaluate(k + 1 == tries ? last : first + k * spacing);
  if (best == kNever) return false;
  double reach = spacing / 2;
  while (reach > 1e-3) {
    const double centre = join_;
    evaluate(std::max(first, centre - reach));
    evaluate(std::min(last, centre + reach));
    reach /= 2;
  }
  connect_ = meeting(now, next, limits, join_, 0);
  return true;
}

bool TrajectorySwitch::earliest_meeting(const MotionState3& now, const SegmentTable& next,
                                        const KinematicLimits& limits,
                                        const SwitchSettings& settings) noexcept {
  constexpr double kStep = 2e-3;
  double t = std::max(0.0, settings.first), missed = -1;
  bool met = false;
  for (int k = 0; k < 2000 && !met; ++k) {
    const double when = meeting(now, next, limits, t, t);
    met = when <= t;
    if (met) break;
    missed = t;
    t = when == kNever ? t + kStep : std::max(when, t + kStep);
  }
  if (!met) return false;
  double good = t;
  while (missed >= 0 && good - missed > 1e-6) {
    const double middle = 0.5 * (good + missed);
    (meeting(now, next, limits, middle, middle) <= middle ? good : missed) = middle;
  }
  join_ = good;
  connect_ = meeting(now, next, limits, good, good);
  return connect_ <= good;
}

bool TrajectorySwitch::make_profiles(const MotionState3& now,
                                     const KinematicLimits& guard) noexcept {
  for (int i = 0; i < n_; ++i) {
    if (connect_ == 0) {
      profiles_[i].clear();
      start_[i] = {now.position[i], now.velocity[i], now.acceleration[i]};
      continue;
    }
    if (problems_[i].profile(connect_, profiles_[i]) != AxisOutcome::ok) return false;
    start_[i] = {now.position[i], now.velocity[i], now.acceleration[i]};
    const AxisExtremes e =
        rate_extremes(start_[i], profiles_[i].segments.data(), profiles_[i].count);
    const double allowed = 1 + kTolerance;
    if (e.velocity > guard.velocity[i] * allowed ||
        e.acceleration > guard.acceleration[i] * allowed || e.jerk > guard.jerk[i] * allowed) {
      return false;
    }
  }
  return true;
}

SwitchOutcome TrajectorySwitch::plan(const MotionState3& now, const SegmentTable& next,
                                     const KinematicLimits& limits,
                                     const SwitchSettings& settings) noexcept {
  if (n_ == 0 || next.axes() != n_ || now.position.size() != n_ || now.velocity.size() != n_ ||
      now.acceleration.size() != n_ || limits.velocity.size() != n_ ||
      limits.acceleration.size() != n_ || limits.jerk.size() != n_) {
    return SwitchOutcome::wrong_size;
  }
  if (!now.position.allFinite() || !now.velocity.allFinite() || !now.acceleration.allFinite())
    return SwitchOutcome::not_finite;
  const double reserve = std::max(1.0, settings.reserve);
  bool beyond = false;
  for (int i = 0; i < n_; ++i) {
    const double V = limits.velocity[i], A = limits.acceleration[i], J = limits.jerk[i],
                 a = now.acceleration[i];
    if (!(V > 0 && A > 0 && J > 0) || !std::isfinite(V + A + J)) return SwitchOutcome::bad_limits;
    const double leads_to = now.velocity[i] + a * std::abs(a) / (2 * J), allowed = 1 + kTolerance;
    beyond = beyond || std::abs(a) > A * allowed || std::abs(now.velocity[i]) > V * allowed ||
             std::abs(leads_to) > V * allowed;
  }
  if (beyond) return SwitchOutcome::start_beyond_limits;
  for (const double scale : {reserve, std::sqrt(reserve), 1.0}) {
    reduced_.velocity = limits.velocity / scale;
    reduced_.acceleration = limits.acceleration / scale;
    reduced_.jerk = limits.jerk / scale;
    const bool found = settings.on_clock ? earliest_meeting(now, next, reduced_, settings)
                                         : best_place(now, next, reduced_, settings);
    if (found && make_profiles(now, limits)) return SwitchOutcome::ok;
  }
  return SwitchOutcome::nowhere;
}

int TrajectorySwitch::segments() const noexcept {
  int sum = 0;
  for (const AxisProfile& p : profiles_) sum += p.count;
  return sum;
}

void TrajectorySwitch::add_to(SegmentTable& out, const SegmentTable& next) noexcept {
  for (int i = 0; i < n_; ++i) {
    at_[i] = 0;
    left_[i] = profiles_[i].count > 0 ? profiles_[i].segments[0].duration : kNever;
  }
  for (double t = 0;;) {
    const double step = *std::min_element(left_.begin(), left_.end());
    if (step == kNever) break;
    for (int i = 0; i < n_; ++i) {
      there_.position[i] = start_[i].position;
      there_.velocity[i] = start_[i].velocity;
      there_.acceleration[i] = start_[i].acceleration;
      jerk_[i] = at_[i] < profiles_[i].count ? profiles_[i].segments[at_[i]].jerk : 0.0;
      start_[i] = advanced(start_[i], step, jerk_[i]);
      if ((left_[i] -= step) <= 0)
        left_[i] = ++at_[i] < profiles_[i].count ? profiles_[i].segments[at_[i]].duration : kNever;
    }
    t += step;
    if (step > kMinDuration)
      out.add(step, there_.position.data(), there_.velocity.data(), there_.acceleration.data(),
              jerk_.data());
  }
  add_part(next, join_, next.duration(), out, there_);
}

AxisOutcome replan_axis(const AxisState& from, const AxisState& to, const AxisLimits& limits,
                        AxisProfile& out) noexcept {
  AxisProblem problem, wider;
  const AxisOutcome outcome = problem.init(from, to, limits);
  if (outcome != AxisOutcome::ok) return outcome;
  problem.minimum_profile(out);
  for (const double by : {1e-9, 1e-7}) {
    const AxisLimits l{limits.velocity * (1 + by), limits.acceleration * (1 + by),
                       limits.jerk * (1 + by)};
    if (wider.init(from, to, l) == AxisOutcome::ok &&
        wider.minimum() < problem.minimum() * (1 - 1e-3) - 1e-9) {
      wider.minimum_profile(out);
      break;
    }
  }
  return AxisOutcome::ok;
}

void add_part(const SegmentTable& from, double begin, double end, SegmentTable& out,
              MotionState3& state) noexcept {
  if (!(end - begin > kMinDuration)) return;
  int cursor = 0;
  for (int k = from.find(begin, 0); k < from.segments() && from.knot(k) < end; ++k) {
    const double start = std::max(begin, from.knot(k)),
                 length = std::min(end, from.knot(k + 1)) - start;
    if (!(length > kMinDuration)) continue;
    cursor = k;
    from.evaluate(start, cursor, state);
    out.add(length, state.position.data(), state.velocity.data(), state.acceleration.data(),
            from.jerks(k));
  }
}

Switched switch_to(const MotionState3& now, const Trajectory& next, const KinematicLimits& limits,
                   const SwitchSettings& settings) {
  Switched out;
  if (out.reason = why_not_within(next, limits, kTolerance); !out.ok()) {
    out.reason = "the new trajectory: " + out.reason;
    return out;
  }
  const SegmentTable table(next);
  TrajectorySwitch connection(next.size());
  if (const SwitchOutcome outcome = connection.plan(now, table, limits, settings);
      outcome != SwitchOutcome::ok) {
    out.reason = reason(outcome);
    return out;
  }
  out.joins_at = connection.joins_at();
  out.connecting = connection.duration();
  SegmentTable joined;
  joined.clear(next.size());
  connection.add_to(joined, table);
  out.trajectory = to_trajectory(joined);
  if (joined.segments() == 0) out.trajectory = standing(now.position);
  return out;
}

}  // namespace handsel
