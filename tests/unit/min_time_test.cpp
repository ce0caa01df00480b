#include "common/trajectory/min_time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/trajectory/limits_check.hpp"
#include "tests/support/slow_min_time.hpp"

namespace handsel {
namespace {

struct Case {
  AxisState from, to;
  AxisLimits limits;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  out.precision(17);
  return out << "from " << c.from.position << ' ' << c.from.velocity << ' ' << c.from.acceleration << " to " << c.to.position << ' '
             << c.to.velocity << ' ' << c.to.acceleration << " limits " << c.limits.velocity << ' ' << c.limits.acceleration << ' '
             << c.limits.jerk;
}

class Cases {
 public:
  explicit Cases(std::uint64_t seed) : random_(seed) {}
  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }

  /// Any family: rest, moving, accelerating, discrete grids, V J = A^2, tiny and huge scales.
  Case next() {
    Case c;
    const int family = pick(7);
    c.limits = {uniform(0.1, 4), uniform(0.1, 6), uniform(0.1, 12)};
    if (family == 1) c.limits.jerk = c.limits.acceleration * c.limits.acceleration / c.limits.velocity;
    if (family == 2) c.limits = {1.0 + pick(2), 1.0 + pick(2), 1.0 + pick(2)};
    double scale = 1;
    if (family == 3) scale = std::pow(10.0, uniform(-6, 6));
    c.limits.velocity *= scale, c.limits.acceleration *= scale, c.limits.jerk *= scale;
    c.from.position = uniform(-3, 3) * scale;
    c.to.position = uniform(-3, 3) * scale;
    if (family == 2) c.from.position = pick(3) - 1, c.to.position = pick(3) - 1;
    if (family == 4) c.to.position = c.from.position + uniform(-1, 1) * std::pow(10.0, -pick(14));
    if (family != 5) fill(c.from, c.limits, family), fill(c.to, c.limits, family);
    if (family == 6) c.to.velocity = c.to.acceleration = 0;
    return c;
  }

 private:
  void fill(AxisState& s, const AxisLimits& l, int family) {
    for (;;) {
      s.velocity = uniform(-1, 1) * l.velocity;
      s.acceleration = uniform(-1, 1) * l.acceleration;
      if (family == 2) s.velocity = (pick(3) - 1), s.acceleration = (pick(3) - 1);
      if (pick(4) == 0) s.acceleration = 0;
      if (pick(6) == 0) s.velocity = 0;
      const double k = s.acceleration * std::abs(s.acceleration) / (2 * l.jerk);
      if (std::abs(s.velocity) <= l.velocity && std::abs(s.acceleration) <= l.acceleration && std::abs(s.velocity + k) <= l.velocity &&
          std::abs(s.velocity - k) <= l.velocity) {
        return;
      }
    }
  }
  std::mt19937_64 random_;
};

std::string why_wrong(const Case& c, const AxisProfile& p, bool check_limits = true, double tolerance = 1e-9) {
  AxisState s = c.from;
  for (int k = 0; k < p.count; ++k) s = advanced(s, p.segments[k].duration, p.segments[k].jerk);
  const double T = p.duration();
  const double reach = std::abs(c.from.position) + std::abs(c.to.position) + c.limits.velocity * T;
  if (std::abs(s.position - c.to.position) > tolerance * reach) return "ends off by " + std::to_string(s.position - c.to.position);
  if (std::abs(s.velocity - c.to.velocity) > tolerance * c.limits.velocity) return "end velocity";
  if (std::abs(s.acceleration - c.to.acceleration) > tolerance * c.limits.acceleration) return "end acceleration";
  if (!check_limits) return {};
  const AxisExtremes e = extremes(c.from, p.segments.data(), p.count);
  if (e.velocity > c.limits.velocity * (1 + tolerance)) return "velocity limit";
  if (e.acceleration > c.limits.acceleration * (1 + tolerance)) return "acceleration limit";
  if (e.jerk > c.limits.jerk * (1 + tolerance)) return "jerk limit";
  return {};
}

TEST(MinTime, EqualsTheSlowSolverOnRandomCases) {
  const int count = std::getenv("HANDSEL_CASES") ? std::atoi(std::getenv("HANDSEL_CASES")) : 20000;
  const std::uint64_t seed = 11;
  Cases cases(seed);
  double worst = 0;
  for (int k = 0; k < count; ++k) {
    const Case c = cases.next();
    AxisProfile p;
    ASSERT_EQ(solve_axis(c.from, c.to, c.limits, p), AxisOutcome::ok) << "seed " << seed << " case " << k << ' ' << c;
    ASSERT_EQ(why_wrong(c, p), "") << "seed " << seed << " case " << k << ' ' << c;
    if (k % 5 == 0) {
      const double slow = test::slow_min_time(c.from, c.to, c.limits), T = p.duration();
      ASSERT_LE(T, slow * (1 + 1e-7) + 1e-12) << "seed " << seed << " case " << k << ' ' << c;
      if (slow > 0 && std::isfinite(slow)) worst = std::max(worst, (slow - T) / slow);
    }
  }
  RecordProperty("largest_gain_over_slow", std::to_string(worst));
}

TEST(MinTime, ImposedDurationsAreExactAndInside) {
  const std::uint64_t seed = 12;
  Cases cases(seed);
  int blocked = 0;
  for (int k = 0; k < 100000; ++k) {
    const Case c = cases.next();
    AxisProblem problem;
    ASSERT_EQ(problem.init(c.from, c.to, c.limits), AxisOutcome::ok) << c;
    const double wanted = problem.minimum() * (1 + 3 * std::pow(cases.uniform(0, 1), 3));
    const double T = problem.earliest(wanted);
    AxisProfile p;
    if (T > wanted) {
      ++blocked;
      ASSERT_EQ(problem.profile(0.5 * (wanted + T), p), AxisOutcome::blocked) << "seed " << seed << " case " << k << ' ' << c;
    }
    ASSERT_EQ(problem.profile(T, p), AxisOutcome::ok) << "seed " << seed << " case " << k << ' ' << c;
    ASSERT_EQ(why_wrong(c, p), "") << "seed " << seed << " case " << k << ' ' << c << " T " << T << " wanted " << wanted;
    ASSERT_NEAR(p.duration(), T, 1e-11 * T);
  }
  EXPECT_GT(blocked, 500);
}

TEST(MinTime, StartsOutsideTheLimitsComeBackInside) {
  const std::uint64_t seed = 13;
  Cases cases(seed);
  for (int k = 0; k < 100000; ++k) {
    Case c = cases.next();
    c.from.velocity *= cases.uniform(1, 3);
    c.from.acceleration *= cases.uniform(1, 3);
    AxisProfile p;
    ASSERT_EQ(solve_axis(c.from, c.to, c.limits, p), AxisOutcome::ok) << c;
    ASSERT_EQ(why_wrong(c, p, false, 1e-8), "") << "seed " << seed << " case " << k << ' ' << c;
    const AxisExtremes e = extremes(c.from, p.segments.data(), p.count);
    ASSERT_LE(e.jerk, c.limits.jerk * (1 + 1e-9)) << c;
    ASSERT_LE(e.acceleration, std::max(std::abs(c.from.acceleration), c.limits.acceleration) * (1 + 1e-9)) << c;
  }
}

TEST(MinTime, AStateOnTheWayNeedsTheRestOfTheTime) {
  const std::uint64_t seed = 14;
  Cases cases(seed);
  for (int k = 0; k < 20000; ++k) {
    Case c = cases.next();
    AxisProfile p, rest;
    ASSERT_EQ(solve_axis(c.from, c.to, c.limits, p), AxisOutcome::ok);
    const double T = p.duration(), t = cases.uniform(0, 1) * T;
    AxisState s = c.from;
    double left = t;
    for (int i = 0; i < p.count && left > 0; ++i) {
      const double step = std::min(left, p.segments[i].duration);
      s = advanced(s, step, p.segments[i].jerk);
      left -= step;
    }
    // Accelerations of one sign leave short durations isolated: there rounding decides.
    if (s.acceleration * c.to.acceleration > 0) continue;
    // The state carries the rounding of the whole way, so the target may be moved by as much.
    double nearest = INFINITY;
    const double rounding = 1e-14 * (std::abs(c.from.position) + std::abs(c.to.position) + c.limits.velocity * T);
    for (const double shift : {0.0, rounding, -rounding}) {
      AxisState to = c.to;
      to.position += shift;
      ASSERT_EQ(solve_axis(s, to, c.limits, rest), AxisOutcome::ok) << c;
      nearest = std::min(nearest, std::abs(rest.duration() - (T - t)));
    }
    ASSERT_LT(nearest, 2e-4 * (T + 1)) << "seed " << seed << " case " << k << ' ' << c << " t " << t;
  }
}

TEST(MinTime, RestToRestClosedForm) {
  EXPECT_NEAR(rest_to_rest_time(1.0, {0.1, 0.3, 0.9}), 10.0 + 2.0 / 3.0, 1e-12);
  Cases cases(15);
  for (int k = 0; k < 100000; ++k) {
    Case c = cases.next();
    c.from.velocity = c.from.acceleration = c.to.velocity = c.to.acceleration = 0;
    AxisProfile p;
    ASSERT_EQ(solve_axis(c.from, c.to, c.limits, p), AxisOutcome::ok);
    ASSERT_NEAR(p.duration(), rest_to_rest_time(c.to.position - c.from.position, c.limits), 1e-10 * (p.duration() + 1e-9)) << c;
  }
}

TEST(MinTime, AHairFromTheTarget) {
  AxisProfile p;
  ASSERT_EQ(solve_axis({0.0049921875, 0, 0}, {0.005, 0, 0}, {1e6, 1e6, 1e6}, p), AxisOutcome::ok);
  EXPECT_EQ(why_wrong({{0.0049921875, 0, 0}, {0.005, 0, 0}, {1e6, 1e6, 1e6}}, p), "");
  for (const double hair : {1e-13, -1e-13, 1e-300, 0.0}) {
    for (const double v : {0.0, 0.5, -1.0}) {
      for (const double a : {0.0, 1e-13, 0.3}) {
        const Case c{{1.0, v + hair, a}, {1.0 + hair, v, a - hair}, {2, 2, 2}};
        ASSERT_EQ(solve_axis(c.from, c.to, c.limits, p), AxisOutcome::ok);
        EXPECT_EQ(why_wrong(c, p), "") << c;
      }
    }
  }
}

TEST(MinTime, BadInputHasAReason) {
  AxisProfile p;
  const double nan = std::nan("");
  EXPECT_EQ(solve_axis({nan, 0, 0}, {}, {1, 1, 1}, p), AxisOutcome::not_finite);
  EXPECT_EQ(solve_axis({}, {0, INFINITY, 0}, {1, 1, 1}, p), AxisOutcome::not_finite);
  EXPECT_EQ(solve_axis({}, {}, {1, 0, 1}, p), AxisOutcome::bad_limits);
  EXPECT_EQ(solve_axis({}, {}, {1, 1, -1}, p), AxisOutcome::bad_limits);
  EXPECT_EQ(solve_axis({}, {0, 2, 0}, {1, 1, 1}, p), AxisOutcome::end_beyond_limits);
  EXPECT_EQ(solve_axis({}, {0, 0.9, -1}, {1, 1, 1}, p), AxisOutcome::end_beyond_limits);
  AxisProblem problem;
  ASSERT_EQ(problem.init({}, {1, 0, 0}, {1, 1, 1}), AxisOutcome::ok);
  EXPECT_EQ(problem.profile(0.5 * problem.minimum(), p), AxisOutcome::too_short);
}

}  // namespace
}  // namespace handsel
