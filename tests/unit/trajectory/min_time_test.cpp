// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/min_time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/trajectory/limits_check.hpp"
#include "tests/support/motion_cases.hpp"
#include "tests/support/oracles/slow_min_time.hpp"

namespace handsel::min_time_test {
namespace {

using test::Case;
using test::Cases;
using test::why_wrong;

TEST(MinTime, equals_the_slow_solver_on_random_cases) {
  const int count = std::getenv("HANDSEL_CASES") ? std::atoi(std::getenv("HANDSEL_CASES")) : 20000;
  const std::uint64_t seed = 11;
  Cases cases(seed);
  double worst = 0;
  for (int k = 0; k < count; ++k) {
    const Case c = cases.next();
    AxisProfile p;
    ASSERT_EQ(solve_axis(c.from, c.to, c.limits, p), AxisOutcome::ok)
        << "seed " << seed << " case " << k << ' ' << c;
    ASSERT_EQ(why_wrong(c, p), "") << "seed " << seed << " case " << k << ' ' << c;
    if (k % 5 == 0) {
      const double slow = test::slow_min_time(c.from, c.to, c.limits), T = p.duration();
      ASSERT_LE(T, slow * (1 + 1e-7) + 1e-12) << "seed " << seed << " case " << k << ' ' << c;
      if (slow > 0 && std::isfinite(slow)) worst = std::max(worst, (slow - T) / slow);
    }
  }
  RecordProperty("largest_gain_over_slow", std::to_string(worst));
}

TEST(MinTime, imposed_durations_are_exact_and_inside) {
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
      ASSERT_EQ(problem.profile(0.5 * (wanted + T), p), AxisOutcome::blocked)
          << "seed " << seed << " case " << k << ' ' << c;
    }
    ASSERT_EQ(problem.profile(T, p), AxisOutcome::ok)
        << "seed " << seed << " case " << k << ' ' << c;
    ASSERT_EQ(why_wrong(c, p), "")
        << "seed " << seed << " case " << k << ' ' << c << " T " << T << " wanted " << wanted;
    ASSERT_NEAR(p.duration(), T, 1e-11 * T);
  }
  EXPECT_GT(blocked, 500);
}

TEST(MinTime, starts_outside_the_limits_come_back_inside) {
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
    ASSERT_LE(e.acceleration,
              std::max(std::abs(c.from.acceleration), c.limits.acceleration) * (1 + 1e-9))
        << c;
  }
}

TEST(MinTime, a_state_on_the_way_needs_the_rest_of_the_time) {
  const std::uint64_t seed = 14;
  Cases cases(seed);
  for (int k = 0; k < 20000; ++k) {
    Case c = cases.next(cases.pick(7));
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
    // With accelerations of one sign, short durations are isolated and depend on rounding.
    if (s.acceleration * c.to.acceleration > 0) continue;
    // The state contains the rounding of the whole motion: the target may shift by as much.
    double nearest = INFINITY;
    const double rounding =
        1e-14 * (std::abs(c.from.position) + std::abs(c.to.position) + c.limits.velocity * T);
    for (const double shift : {0.0, rounding, -rounding}) {
      AxisState to = c.to;
      to.position += shift;
      ASSERT_EQ(solve_axis(s, to, c.limits, rest), AxisOutcome::ok) << c;
      nearest = std::min(nearest, std::abs(rest.duration() - (T - t)));
    }
    ASSERT_LT(nearest, 2e-4 * (T + 1))
        << "seed " << seed << " case " << k << ' ' << c << " t " << t;
  }
}

TEST(MinTime, rest_to_rest_closed_form) {
  EXPECT_NEAR(rest_to_rest_time(1.0, {0.1, 0.3, 0.9}), 10.0 + 2.0 / 3.0, 1e-12);
  Cases cases(15);
  for (int k = 0; k < 100000; ++k) {
    Case c = cases.next();
    c.from.velocity = c.from.acceleration = c.to.velocity = c.to.acceleration = 0;
    AxisProfile p;
    ASSERT_EQ(solve_axis(c.from, c.to, c.limits, p), AxisOutcome::ok);
    ASSERT_NEAR(p.duration(), rest_to_rest_time(c.to.position - c.from.position, c.limits),
                1e-10 * (p.duration() + 1e-9))
        << c;
  }
}

TEST(MinTime, a_hair_from_the_target) {
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

TEST(MinTime, bad_input_has_a_reason) {
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
}  // namespace handsel::min_time_test
