#include "common/trajectory/time_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"

namespace handsel {

namespace {
// Of the guard: what is planned with leaves something for what happens between two steps, and for rounding of what was planned.
constexpr double kMargin = 0.99;
constexpr std::array<double, 3> kSpareMargins{0.994, 0.998, 0.9995};
constexpr double kWhole = 1 - 1e-4;
constexpr double kMaxPush = 100.0;  // [1/s^2]
constexpr double kMaxRate = 20.0;   // [1/s]
constexpr int kHorizon = 600;       // steps of a way back to constant alpha
constexpr double kLanded = 1e-9;

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

std::string TimeLaw::init(const Trajectory& trajectory, const KinematicLimits& guard, double step, double alpha) {
  if (std::string why = why_not_runnable(trajectory, guard); !why.empty()) return why;
  if (!(step > 0) || !(std::abs(alpha) <= 1)) return "the step must be positive and alpha in [-1, 1]";
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
  row_jerk_ = jerk_ = Eigen::VectorXd::Zero(n);
  moving_.reserve(n);
  A_.assign(guard.acceleration.data(), guard.acceleration.data() + n);
  J_.assign(guard.jerk.data(), guard.jerk.data() + n);
  for (Rates* r : {&begin_, &end_, &between_, &here_}) {
    r->v.assign(n, 0.0);
    r->a.assign(n, 0.0);
    r->j.assign(n, 0.0);
    r->segment = 0;
  }
  find_moving();
  step_ = step;
  lowest_ = starts_still ? -1 : 0;
  now_ = {0, alpha, 0};
  target_ = alpha;
  push_ = phase_ = offset_ = joined_at_ = 0;
  cursor_ = 0;
  publish();
  return {};
}

void TimeLaw::find_moving() noexcept {
  moving_.clear();
  for (int i = 0; i < table_.axes(); ++i) jerk_[i] = 0;
  for (int k = 0; k < table_.segments(); ++k) {
    table_.rates(table_.knot(k), k, between_.v.data(), between_.a.data(), between_.j.data());
    for (int i = 0; i < table_.axes(); ++i) jerk_[i] += std::abs(between_.v[i]) + std::abs(between_.a[i]) + std::abs(between_.j[i]);
  }
  for (int i = 0; i < table_.axes(); ++i) {
    if (jerk_[i] > 0) moving_.push_back(i);
    jerk_[i] = 0;
  }
}

SwitchOutcome TimeLaw::take_over(const MotionState3& from, const Now& at, double keep_from, const SegmentTable& next,
                                 const SwitchSettings& settings) noexcept {
  if (const SwitchOutcome found = connection_.plan(from, next, guard_, settings); found != SwitchOutcome::ok) return found;
  const int coming = connection_.segments() + next.segments() + 1;
  if (coming > spare_.room()) return SwitchOutcome::too_long;
  const int before = keep_from < at.tau ? table_.find(at.tau, 0) - table_.find(keep_from, 0) + 1 : 0;
  spare_.clear(table_.axes());
  if (before > 0 && before + coming <= spare_.room()) add_part(table_, keep_from, at.tau, spare_, row_, row_jerk_);
  const Now begin{spare_.segments() > 0 ? spare_.duration() : 0.0, at.alpha, at.beta};
  const bool has_past = spare_.segments() > 0;
  connection_.add_to(spare_, next);
  if (spare_.segments() == 0)
    spare_.add(0.0, from.position.data(), from.velocity.data(), from.acceleration.data(), row_jerk_.setZero().data());
  const Now old = now_;
  const double old_lowest = lowest_;
  std::swap(table_, spare_);
  find_moving();
  now_ = begin;
  lowest_ = has_past ? lowest_ : still(from) ? -1 : 0;
  double unused, end;
  if (at.beta != 0 && !recover(now_, &unused, &end)) {
    std::swap(table_, spare_);
    find_moving();
    now_ = old;
    lowest_ = old_lowest;
    publish();
    return SwitchOutcome::not_now;
  }
  joined_at_ = connection_.joins_at();
  offset_ = begin.tau + connection_.duration() - joined_at_;
  target_ = std::max(target_, lowest_);
  push_ = phase_ = 0;
  cursor_ = 0;
  publish();
  return SwitchOutcome::ok;
}

SwitchOutcome TimeLaw::switch_to(const SegmentTable& next, const SwitchSettings& settings) noexcept {
  if (table_.axes() == 0 || next.axes() != table_.axes()) return SwitchOutcome::wrong_size;
  table_.evaluate(now_.tau, cursor_, from_);
  const bool ended = now_.tau <= 0 ? lowest_ < 0 && still(from_) : now_.tau >= duration();
  if (ended || standing()) {
    from_.velocity.setZero();
    from_.acceleration.setZero();
    return take_over(from_, {0, std::max(0.0, target_), 0}, 0, next, settings);
  }
  if (now_.alpha < 0 || (now_.alpha == 0 && now_.beta < 0)) {
    from_.velocity = -from_.velocity;
    return take_over(from_, {0, -now_.alpha, -now_.beta}, 0, next, settings);
  }
  return take_over(from_, now_, lowest_ < 0 ? 0.0 : now_.tau, next, settings);
}

SwitchOutcome TimeLaw::start_from(const MotionState3& state, const SegmentTable& next, const SwitchSettings& settings) noexcept {
  if (table_.axes() == 0 || next.axes() != table_.axes()) return SwitchOutcome::wrong_size;
  const double target = target_;
  target_ = 1;
  const SwitchOutcome outcome = take_over(state, {0, 1, 0}, 0, next, settings);
  if (outcome != SwitchOutcome::ok) target_ = target;
  return outcome;
}

void TimeLaw::set_target(double alpha) noexcept { target_ = std::isfinite(alpha) ? std::clamp(alpha, lowest_, 1.0) : 0.0; }

TimeLaw::Now TimeLaw::moved(const Now& s, double u, double t) noexcept {
  return {s.tau + t * (s.alpha + t * (s.beta / 2 + t * u / 6)), s.alpha + t * (s.beta + t * u / 2), s.beta + t * u};
}

void TimeLaw::rates_at(double tau, Rates& r) const noexcept {
  if (tau < 0 || tau >= table_.duration()) {
    for (const int i : moving_) r.v[i] = r.a[i] = r.j[i] = 0;
    r.segment = tau < 0 ? 0 : table_.segments() - 1;
    return;
  }
  r.segment = table_.find(tau, r.segment);
  table_.rates(tau, r.segment, r.v.data(), r.a.data(), r.j.data());
}

bool TimeLaw::bounds(const Now& s, const Rates& begin, const Rates& end, double* lo, double* hi) noexcept {
  double low = -kMaxPush, high = kMaxPush;
  bool possible = true;
  const auto within = [&](double c, double w, double bound) {
    if (std::abs(w) < 1e-12) {
      if (std::abs(c) > bound + 1e-9) possible = false;
      return;
    }
    const double inverse = 1 / w, centre = -c * inverse, half = bound * std::abs(inverse);
    low = std::max(low, centre - half);
    high = std::min(high, centre + half);
  };
  const double h = step_;
  const double a0 = s.alpha, a1 = s.alpha + h * s.beta;
  const double a0_squared = a0 * a0, a0_cubed = a0 * a0_squared, a1_squared = a1 * a1, a1_cubed = a1_squared * a1;
  const int from = std::min(begin.segment, end.segment), to = std::max(begin.segment, end.segment);
  for (const int i : moving_) {
    const double steady0 = a0_cubed * begin.j[i];
    within(steady0 + 3 * a0 * s.beta * begin.a[i], begin.v[i], std::max(margin_ * J_[i], std::abs(steady0)));
    const double steady1 = a1_cubed * end.j[i];
    within(steady1 + 3 * a1 * s.beta * end.a[i], end.v[i] + 3 * h * (end.a[i] * (a1 + h * s.beta / 2) + h * a1_squared * end.j[i] / 2),
           std::max(margin_ * J_[i], std::min(std::abs(steady1), std::abs(end.j[i]))));
    const double push1 = a1_squared * end.a[i], gain1 = h * (end.v[i] + h * a1 * end.a[i]);
    within(push1 + s.beta * end.v[i], gain1, std::max(margin_ * A_[i], std::min(std::abs(push1), std::abs(end.a[i]))));
    const double change = push1 - a0_squared * begin.a[i];
    within(change + s.beta * (end.v[i] - begin.v[i]), gain1, std::max(margin_ * J_[i] * h, std::min(std::abs(change), kWhole * J_[i] * h)));
  }
  // Where a step ends is known up to what alpha'' adds; a knot that near is passed, or not.
  const double span = h * (a0 + h * s.beta / 2), unsure = kMaxPush * h * h * h / 6, stop = s.tau + span;
  const bool on = span >= 0 && to + 1 < table_.segments() && table_.knot(to + 1) - stop < unsure;
  const bool back = span < 0 && from > 0 && stop - table_.knot(from) < unsure;
  for (int k = from - back; k < to + on; ++k) {
    const double knot = table_.knot(k + 1), at = std::clamp(span != 0 ? (knot - s.tau) / span : 0.0, 0.0, 1.0) * h;
    const double ak = a0 + at * s.beta, ak_cubed = ak * ak * ak;
    for (const int side : {k, k + 1}) {
      table_.rates(knot, side, between_.v.data(), between_.a.data(), between_.j.data());
      for (const int i : moving_) {
        const double steady = ak_cubed * between_.j[i];
        within(steady + 3 * ak * s.beta * between_.a[i], between_.v[i] + 3 * ak * between_.a[i] * at,
               std::max(margin_ * J_[i], std::min(std::abs(steady), std::abs(between_.j[i]))));
      }
    }
  }
  *lo = std::max(low, (-kMaxRate - s.beta) / h);
  *hi = std::min(high, (kMaxRate - s.beta) / h);
  return possible && *lo <= *hi;
}

bool TimeLaw::recover(Now s, double* first, double* alpha_end) noexcept {
  *first = 0;
  rates_at(s.tau, begin_);
  for (int k = 0; k < kHorizon; ++k) {
    if (s.beta == 0) {
      *alpha_end = s.alpha;
      return s.alpha >= lowest_ - kLanded && s.alpha <= 1 + kLanded;
    }
    rates_at(s.tau + step_ * (s.alpha + step_ * s.beta / 2), end_);
    double lo, hi;
    if (!bounds(s, begin_, end_, &lo, &hi)) {
      if (k == 0) *first = 0.5 * (lo + hi);
      return false;
    }
    const double u = std::clamp(-s.beta / step_, lo, hi);
    if (k == 0) *first = u;
    s = next_of(s, u);
    std::swap(begin_, end_);
  }
  return false;
}

TimeLaw::Now TimeLaw::next_of(const Now& s, double u) const noexcept {
  Now next = moved(s, u, step_);
  if (u == -s.beta / step_) next.beta = 0;
  return next;
}

double TimeLaw::choose() noexcept {
  if (now_.beta == 0 && std::abs(now_.alpha - target_) <= kLanded) {
    now_.alpha = target_;
    return 0;
  }
  double safe, end_safe;
  if (!recover(now_, &safe, &end_safe)) {
    bool found = false;
    for (std::size_t k = 0; k < kSpareMargins.size() && !found; ++k) {
      margin_ = kSpareMargins[k];
      found = recover(now_, &safe, &end_safe);
    }
    margin_ = kMargin;
    return safe;
  }
  const double want = target_ - end_safe;
  if (std::abs(want) <= kLanded) return safe;
  rates_at(now_.tau, begin_);
  rates_at(now_.tau + step_ * (now_.alpha + step_ * now_.beta / 2), end_);
  double lo, hi, unused;
  if (!bounds(now_, begin_, end_, &lo, &hi)) return safe;
  const double full = (want > 0 ? hi : lo) - safe;
  const auto miss = [&](double share, double* out) {
    double end;
    if (!recover(next_of(now_, safe + share * full), &unused, &end)) return false;
    *out = (target_ - end) * (want > 0 ? 1 : -1);
    return true;
  };
  double share = 1, left = 0;
  while (!miss(share, &left)) {
    share /= 2;
    if (share < 0.05) return safe;
  }
  if (left >= -kLanded) return safe + share * full;
  double under = 0, over = share, left_under = std::abs(want), left_over = left;
  for (int k = 0; k < 20; ++k) {
    double middle = under + (over - under) * left_under / (left_under - left_over);
    if (k % 4 == 3) middle = 0.5 * (under + over);
    if (!miss(middle, &left)) break;
    if (std::abs(left) <= kLanded) return safe + middle * full;
    (left > 0 ? under : over) = middle;
    (left > 0 ? left_under : left_over) = left;
  }
  return safe + under * full;
}

bool TimeLaw::holds(const Now& s, double u) noexcept {
  constexpr double kAllowed = 1 + 5e-7;
  const Now next = next_of(s, u);
  rates_at(s.tau, begin_);
  rates_at(next.tau, end_);
  for (const int i : moving_) {
    const double a0 = s.alpha * s.alpha * begin_.a[i] + s.beta * begin_.v[i];
    const double a1 = next.alpha * next.alpha * end_.a[i] + next.beta * end_.v[i];
    const double j1 = next.alpha * (next.alpha * next.alpha * end_.j[i] + 3 * next.beta * end_.a[i]) + u * end_.v[i];
    if (std::max({std::abs(a1) / A_[i], std::abs(a1 - a0) / (J_[i] * step_), std::abs(j1) / J_[i]}) > kAllowed) return false;
  }
  return true;
}

/// The choice, or one near it where curvature within the step would carry it beyond a limit.
double TimeLaw::amended(double u) noexcept {
  if (holds(now_, u)) return u;
  double unused, end;
  for (double by = 0.05; by < 60; by *= 2) {
    for (const double other : {u - by, u + by}) {
      if (holds(now_, other) && recover(next_of(now_, other), &unused, &end)) return other;
    }
  }
  return u;
}

void TimeLaw::advance(double dt) noexcept {
  while (dt > 0) {
    if (phase_ == 0) {
      push_ = amended(choose());
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

void TimeLaw::publish() noexcept {
  table_.evaluate(now_.tau, cursor_, state_);
  rates_at(now_.tau, here_);
  const double a = now_.alpha, b = now_.beta;
  for (const int i : moving_) {
    state_.velocity[i] = a * here_.v[i];
    state_.acceleration[i] = a * a * here_.a[i] + b * here_.v[i];
    jerk_[i] = a * a * a * here_.j[i] + 3 * a * b * here_.a[i] + push_ * here_.v[i];
  }
}

}  // namespace handsel
