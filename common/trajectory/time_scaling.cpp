// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/time_scaling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"

namespace handsel {

namespace {
// Fraction of the guard limits used for planning, which leaves a margin for the motion between two
// steps and for rounding.
constexpr double kMargin = 0.99;
constexpr double kAllowed = 1 + 5e-7;
constexpr double kWhole = 1 - 1e-4;
constexpr double kMaxPush = 0.8;   // max change of alpha' in one step [1/s]
constexpr double kMaxRate = 28.0;  // max alpha' [1/s]
constexpr int kHorizon = 600;      // max steps of a recovery to constant alpha
constexpr double kLanded = 1e-9;

/// Returns tau, alpha and its rate after a time of constant alpha''.
template <typename State>
State moved(const State& s, double u, double t) noexcept {
  return {s.tau + t * (s.alpha + t * (s.beta / 2 + t * u / 6)), s.alpha + t * (s.beta + t * u / 2),
          s.beta + t * u};
}

bool still(const MotionState3& s) noexcept {
  return s.velocity.cwiseAbs().maxCoeff() < 1e-6 && s.acceleration.cwiseAbs().maxCoeff() < 1e-5;
}
}  // namespace

std::string why_not_runnable(const Trajectory& trajectory, const KinematicLimits& guard) {
  if (trajectory.size() == 0) return "the trajectory has no axes";
  if (std::string why = why_not_within(trajectory, guard, 1e-6); !why.empty()) return why;
  if (!still(final_state(trajectory))) return "the trajectory does not end at rest";
  return {};
}

std::string TimeScaling::init(const Trajectory& trajectory, const KinematicLimits& guard,
                              double step, double alpha) {
  if (std::string why = why_not_runnable(trajectory, guard); !why.empty()) return why;
  if (!(step > 0) || !(std::abs(alpha) <= 1))
    return "the step must be positive and alpha in [-1, 1]";
  const MotionState3 start = trajectory.at(0);
  const bool starts_still = still(start);
  if (!starts_still && alpha != 1) return "a trajectory that starts moving must start with alpha 1";
  table_ = SegmentTable(trajectory);
  const int n = table_.axes();
  table_.reserve(n, kRoom);
  spare_.clear(n);
  spare_.reserve(n, kRoom);
  connection_ = TrajectorySwitch(n);
  guard_ = guard;
  from_ = row_ = state_ = start;
  jerk_ = Eigen::VectorXd::Zero(n);
  const auto rows = static_cast<std::size_t>(table_.stride() / detail::kBatchAxes);
  limits_.assign(2 * rows, detail::BatchRow{{1, 1, 1, 1, 1, 1, 1, 1}});
  std::copy_n(guard.acceleration.data(), n, limits_.data()->value);
  std::copy_n(guard.jerk.data(), n, limits_.data()->value + table_.stride());
  for (Rates* r : {&begin_, &end_, &between_}) *r = {0, std::vector<detail::BatchRow>(3 * rows)};
  for (Recovery* w : {&recovery_, &tried_, &best_}) w->pushes.resize(kHorizon);
  recovery_.stay(alpha);
  step_ = step;
  lowest_ = starts_still ? -1 : 0;
  now_ = {0, alpha, 0};
  target_ = alpha;
  push_ = phase_ = offset_ = joined_at_ = switched_at_ = 0;
  cursor_ = 0;
  publish();
  return {};
}

SwitchOutcome TimeScaling::take_over(const MotionState3& from, const Now& at, double keep_from,
                                     double leave, const SegmentTable& next,
                                     const SwitchSettings& settings) noexcept {
  if (const SwitchOutcome found = connection_.plan(from, next, guard_, settings);
      found != SwitchOutcome::ok)
    return found;
  const int coming = connection_.segments() + next.segments() + 1;
  const auto fits = [&](double begin) {
    return (begin < leave ? table_.find(leave, 0) - table_.find(begin, 0) + 1 : 0) + coming <=
           spare_.room();
  };
  const bool ahead = leave > at.tau;
  const double kept = fits(keep_from) ? keep_from : ahead ? std::max(0.0, at.tau) : leave;
  if (!fits(kept)) return SwitchOutcome::too_long;
  before_ = {now_, lowest_, target_, offset_, joined_at_, switched_at_};
  spare_.clear(table_.axes());
  if (kept < leave) add_part(table_, kept, leave, spare_, row_);
  const bool has_past = spare_.segments() > 0;
  switched_at_ = has_past ? spare_.duration() : 0.0;
  connection_.add_to(spare_, next);
  if (spare_.segments() == 0)
    spare_.add(0.0, from.position.data(), from.velocity.data(), from.acceleration.data(),
               jerk_.setZero().data());
  std::swap(table_, spare_);
  now_ = {ahead ? at.tau - kept : switched_at_, at.alpha, at.beta};
  if (!has_past)
    lowest_ = still(from) ? -1 : 0;
  else if (kept > keep_from)
    lowest_ = 0;
  joined_at_ = connection_.joins_at();
  offset_ = switched_at_ + connection_.duration() - joined_at_;
  target_ = std::max(target_, lowest_);
  if (!recover(now_, tried_)) {
    back_to_before();
    return SwitchOutcome::not_now;
  }
  std::swap(recovery_, tried_);
  push_ = phase_ = 0;
  cursor_ = 0;
  publish();
  return SwitchOutcome::ok;
}

void TimeScaling::back_to_before() noexcept {
  std::swap(table_, spare_);
  now_ = before_.now;
  lowest_ = before_.lowest;
  target_ = before_.target;
  offset_ = before_.offset;
  joined_at_ = before_.joined_at;
  switched_at_ = before_.switched_at;
  cursor_ = 0;
  publish();
}

void TimeScaling::undo_switch() noexcept {
  std::swap(recovery_, tried_);
  back_to_before();
}

SwitchOutcome TimeScaling::switch_to(const SegmentTable& next,
                                     const SwitchSettings& settings) noexcept {
  if (table_.axes() == 0 || next.axes() != table_.axes()) return SwitchOutcome::wrong_size;
  table_.evaluate(now_.tau, cursor_, from_);
  const bool ended = now_.tau <= 0 ? lowest_ < 0 && still(from_) : now_.tau >= duration();
  if (ended || standing()) {
    from_.velocity.setZero();
    from_.acceleration.setZero();
    return take_over(from_, {0, std::max(0.0, target_), 0}, 0, 0, next, settings);
  }
  if (now_.alpha < 0 || (now_.alpha == 0 && now_.beta < 0)) {
    from_.velocity = -from_.velocity;
    return take_over(from_, {0, -now_.alpha, -now_.beta}, 0, 0, next, settings);
  }
  return take_over(from_, now_, lowest_ < 0 ? 0.0 : now_.tau, now_.tau, next, settings);
}

SwitchOutcome TimeScaling::switch_at(double leave, const SegmentTable& next,
                                     const SwitchSettings& settings) noexcept {
  if (!(leave > now_.tau) || !(now_.tau < duration())) return switch_to(next, settings);
  if (table_.axes() == 0 || next.axes() != table_.axes()) return SwitchOutcome::wrong_size;
  leave = std::min(leave, duration());
  table_.evaluate(leave, cursor_, from_);
  if (leave == duration()) {
    from_.velocity.setZero();
    from_.acceleration.setZero();
  }
  return take_over(from_, now_, lowest_ < 0 ? 0.0 : std::max(0.0, now_.tau), leave, next, settings);
}

SwitchOutcome TimeScaling::start_from(const MotionState3& state, const SegmentTable& next,
                                      const SwitchSettings& settings) noexcept {
  if (table_.axes() == 0 || next.axes() != table_.axes()) return SwitchOutcome::wrong_size;
  const double target = target_;
  target_ = 1;
  const SwitchOutcome outcome = take_over(state, {0, 1, 0}, 0, 0, next, settings);
  if (outcome != SwitchOutcome::ok) target_ = target;
  return outcome;
}

bool TimeScaling::begin_with(double alpha) noexcept {
  table_.evaluate(now_.tau, cursor_, row_);
  if (!still(row_)) return false;
  target_ = now_.alpha = std::isfinite(alpha) ? std::clamp(alpha, 0.0, 1.0) : 0.0;
  now_.beta = push_ = phase_ = 0;
  recovery_.stay(now_.alpha);
  publish();
  return true;
}

void TimeScaling::set_target(double alpha) noexcept {
  target_ = std::isfinite(alpha) ? std::clamp(alpha, lowest_, 1.0) : 0.0;
}

void TimeScaling::rates_at(double tau, Rates& r) const noexcept {
  if (tau < 0 || tau >= table_.duration()) {
    std::fill(r.values.begin(), r.values.end(), detail::BatchRow{});
    r.segment = tau < 0 ? 0 : table_.segments() - 1;
    return;
  }
  r.segment = table_.find(tau, r.segment);
  table_.rates(tau, r.segment, r.data());
}

detail::ScalingStep TimeScaling::step_from(const Now& s) const noexcept {
  return {s.alpha, s.beta, step_, kMargin, kWhole, limits_.data()->value, table_.stride()};
}

bool TimeScaling::pushes(const Now& s, const Rates& begin, const Rates& end,
                         double* range) noexcept {
  const detail::BatchKernels& kernels = detail::batch_kernels();
  const detail::ScalingStep at = step_from(s);
  const double h = step_;
  range[0] = std::max(-kMaxPush / h, (-kMaxRate - s.beta) / h);
  range[1] = std::min(kMaxPush / h, (kMaxRate - s.beta) / h);
  bool possible = kernels.push_range(at, begin.data(), end.data(), range);
  const int from = std::min(begin.segment, end.segment), to = std::max(begin.segment, end.segment);
  // The end of a step is known up to the effect of alpha''; whether so near a knot is passed is
  // unknown.
  const double span = h * (s.alpha + h * s.beta / 2), unsure = kMaxPush * h * h / 6,
               stop = s.tau + span;
  const bool on = span >= 0 && to + 1 < table_.segments() && table_.knot(to + 1) - stop < unsure;
  const bool back = span < 0 && from > 0 && stop - table_.knot(from) < unsure;
  for (int k = from - back; k < to + on; ++k) {
    const double knot = table_.knot(k + 1),
                 after = std::clamp(span != 0 ? (knot - s.tau) / span : 0.0, 0.0, 1.0) * h;
    for (const int side : {k, k + 1}) {
      table_.rates(knot, side, between_.data());
      possible = kernels.push_range_at(at, after, between_.data(), range) && possible;
    }
  }
  return possible && range[0] <= range[1];
}

bool TimeScaling::holds(const Now& s, const Now& next, double push) const noexcept {
  return detail::batch_kernels().step_holds(step_from(s), step_from(next), push, kAllowed,
                                            begin_.data(), end_.data());
}

/// Computes the recovery to a constant alpha; returns false if it violates a limit. If alpha leaves
/// its range, the recovery ends with that value.
bool TimeScaling::recover(Now s, Recovery& out) noexcept {
  const auto allowed = [this](double alpha) {
    return alpha >= lowest_ - kLanded && alpha <= 1 + kLanded;
  };
  out.next = out.count = 0;
  out.end = std::numeric_limits<double>::quiet_NaN();
  rates_at(s.tau, begin_);
  while (s.beta != 0) {
    if (!allowed(s.alpha)) {
      out.end = s.alpha;
      return false;
    }
    if (out.count == kHorizon) return false;
    rates_at(s.tau + step_ * (s.alpha + step_ * s.beta / 2), end_);
    double range[2];
    if (!pushes(s, begin_, end_, range)) return false;
    const double u = std::clamp(-s.beta / step_, range[0], range[1]);
    const Now next = next_of(s, u);
    rates_at(next.tau, end_);
    if (!holds(s, next, u)) return false;
    out.pushes[static_cast<std::size_t>(out.count++)] = u;
    s = next;
    std::swap(begin_, end_);
  }
  out.end = s.alpha;
  return allowed(s.alpha);
}

TimeScaling::Now TimeScaling::next_of(const Now& s, double u) const noexcept {
  if (s.beta == 0 && u == 0) return {s.tau + step_ * s.alpha, s.alpha, 0};
  Now next = moved(s, u, step_);
  if (u == -s.beta / step_) next.beta = 0;
  return next;
}

double TimeScaling::choose() noexcept {
  if (now_.beta == 0 && std::abs(now_.alpha - target_) <= kLanded) {
    now_.alpha = target_;
    recovery_.stay(target_);
    return 0;
  }
  const double want = target_ - recovery_.end;
  if (std::abs(want) <= kLanded) return recovery_.take();
  rates_at(now_.tau, begin_);
  rates_at(now_.tau + step_ * (now_.alpha + step_ * now_.beta / 2), end_);
  double range[2];
  if (!pushes(now_, begin_, end_, range)) return recovery_.take();
  const double safe = recovery_.next < recovery_.count
                          ? recovery_.pushes[static_cast<std::size_t>(recovery_.next)]
                          : 0.0,
               full = range[want > 0] - safe;
  const auto miss = [&](double ratio, double* out) {
    const double u = safe + ratio * full;
    const Now next = next_of(now_, u);
    rates_at(now_.tau, begin_);
    rates_at(next.tau, end_);
    if (!holds(now_, next, u)) return false;
    const bool kept = recover(next, tried_);
    *out = (target_ - tried_.end) * (want > 0 ? 1 : -1);
    return kept || *out < 0;  // outside its range alpha is also beyond the target: too far
  };
  const auto go = [&](double ratio, Recovery& with) {
    std::swap(recovery_, with);
    return safe + ratio * full;
  };
  double ratio = 1, left = 0;
  while (!miss(ratio, &left)) {
    ratio /= 2;
    if (ratio < 0.006) return recovery_.take();
  }
  if (left >= -kLanded) return go(ratio, tried_);
  double under = 0, over = ratio, left_under = std::abs(want), left_over = left;
  for (int k = 0; k < 20; ++k) {
    double middle = under + (over - under) * left_under / (left_under - left_over);
    if (k % 4 == 3) middle = 0.5 * (under + over);
    if (!miss(middle, &left)) break;
    if (std::abs(left) <= kLanded) return go(middle, tried_);
    if (left > 0) {
      under = middle, left_under = left;
      std::swap(best_, tried_);
    } else {
      over = middle, left_over = left;
    }
  }
  return under > 0 ? go(under, best_) : recovery_.take();
}

void TimeScaling::advance(double dt) noexcept {
  while (dt > 0) {
    if (phase_ == 0) {
      push_ = choose();
      tick_ = now_;
    }
    if (phase_ + dt >= step_ * (1 - 1e-9)) {
      dt = std::max(0.0, dt - (step_ - phase_));
      if (dt < step_ * 1e-9) dt = 0;
      now_ = next_of(tick_, push_);
      phase_ = 0;
    } else {
      phase_ += dt;
      dt = 0;
      now_ = moved(tick_, push_, phase_);
    }
  }
  publish();
}

void TimeScaling::publish() noexcept {
  table_.evaluate(now_.tau, cursor_, state_);
  if (now_.tau < 0 || now_.tau >= table_.duration()) {
    state_.velocity.setZero();
    state_.acceleration.setZero();
    jerk_.setZero();
    return;
  }
  const double a = now_.alpha, b = now_.beta;
  const Eigen::Map<const Eigen::VectorXd> jerk(table_.jerks(cursor_), table_.axes());
  if (a == 1 && b == 0 && push_ == 0) {
    jerk_ = jerk;
    return;
  }
  jerk_ = (a * a * a) * jerk + (3 * a * b) * state_.acceleration + push_ * state_.velocity;
  state_.acceleration = (a * a) * state_.acceleration + b * state_.velocity;
  state_.velocity *= a;
}

}  // namespace handsel
