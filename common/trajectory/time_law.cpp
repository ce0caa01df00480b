#include "common/trajectory/time_law.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"

namespace handsel {

namespace {
constexpr double kMargin = 0.99;    // of the guard, for what happens between two steps
constexpr double kMaxPush = 100.0;  // [1/s^2]
constexpr double kMaxRate = 20.0;   // [1/s]
constexpr int kHorizon = 600;       // steps of a way back to constant alpha
constexpr double kLanded = 1e-9;
}  // namespace

std::string TimeLaw::init(const Trajectory& trajectory, const KinematicLimits& guard, double step, double alpha) {
  if (std::string why = why_not_within(trajectory, guard, 1e-6); !why.empty()) return why;
  if (!(step > 0) || !(std::abs(alpha) <= 1)) return "the step must be positive and alpha in [-1, 1]";
  const MotionState3 end = final_state(trajectory);
  const auto still = [&](const Eigen::VectorXd& v, const Eigen::VectorXd& a) {
    return v.cwiseAbs().maxCoeff() < 1e-6 && a.cwiseAbs().maxCoeff() < 1e-5;
  };
  if (trajectory.size() == 0) return "the trajectory has no axes";
  if (!still(end.velocity, end.acceleration)) return "the trajectory does not end at rest";
  const MotionState3 start = trajectory.at(0);
  const bool starts_still = still(start.velocity, start.acceleration);
  if (!starts_still && alpha != 1) return "a trajectory that starts moving must start with alpha 1";
  table_ = SegmentTable(trajectory);
  const int n = table_.axes();
  moving_.clear();
  for (int i = 0; i < n; ++i) {
    const AxisExtremes e = extremes(trajectory.axes[i]);
    if (e.velocity > 0 || e.jerk > 0) moving_.push_back(i);
  }
  A_.assign(guard.acceleration.data(), guard.acceleration.data() + n);
  J_.assign(guard.jerk.data(), guard.jerk.data() + n);
  for (Rates* r : {&begin_, &end_, &between_, &here_}) {
    r->v.assign(n, 0.0);
    r->a.assign(n, 0.0);
    r->j.assign(n, 0.0);
    r->segment = 0;
  }
  state_ = start;
  jerk_ = Eigen::VectorXd::Zero(n);
  step_ = step;
  lowest_ = starts_still ? -1 : 0;
  now_ = {0, alpha, 0};
  target_ = alpha;
  push_ = phase_ = 0;
  cursor_ = 0;
  publish();
  return {};
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
  const double a0_cubed = a0 * a0 * a0, a1_squared = a1 * a1, a1_cubed = a1_squared * a1;
  const int from = std::min(begin.segment, end.segment), to = std::max(begin.segment, end.segment);
  for (const int i : moving_) {
    const double steady0 = a0_cubed * begin.j[i];
    within(steady0 + 3 * a0 * s.beta * begin.a[i], begin.v[i], std::max(kMargin * J_[i], std::abs(steady0)));
    const double steady1 = a1_cubed * end.j[i];
    within(steady1 + 3 * a1 * s.beta * end.a[i], end.v[i] + 3 * a1 * end.a[i] * h, std::max(kMargin * J_[i], std::abs(steady1)));
    const double push1 = a1_squared * end.a[i];
    within(push1 + s.beta * end.v[i], h * end.v[i], std::max(kMargin * A_[i], std::abs(push1)));
  }
  for (int k = from + 1; k < to; ++k) {
    table_.rates(table_.knot(k), k, between_.v.data(), between_.a.data(), between_.j.data());
    for (const int i : moving_) {
      const double steady = a1_cubed * between_.j[i];
      within(steady + 3 * a1 * s.beta * between_.a[i], between_.v[i], std::max(kMargin * J_[i], std::abs(steady)));
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
    if (!bounds(s, begin_, end_, &lo, &hi)) return false;
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
  if (!recover(now_, &safe, &end_safe)) return safe;
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

void TimeLaw::advance(double dt) noexcept {
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
