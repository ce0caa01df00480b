// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/trajectory.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "common/trajectory/three_segment.hpp"
#include "tests/support/motion_draw.hpp"

namespace handsel::trajectory_test {
namespace {

using Eigen::VectorXd;

struct Draw : test::Draw {
  MotionState3 state(const KinematicLimits& l, double share) {
    const Eigen::Index n = l.velocity.size();
    MotionState3 s = rest_state(VectorXd(n));
    for (Eigen::Index i = 0; i < n; ++i) {
      s.position[i] = (*this)(-2, 2);
      s.velocity[i] = share * (*this)(-1, 1) * l.velocity[i];
      s.acceleration[i] = share * (*this)(-1, 1) *
                          std::min(l.acceleration[i], std::sqrt(l.velocity[i] * l.jerk[i]));
    }
    return s;
  }
  KinematicLimits limits(int n) {
    KinematicLimits l{VectorXd(n), VectorXd(n), VectorXd(n)};
    for (int i = 0; i < n; ++i)
      l.velocity[i] = (*this)(0.3, 3), l.acceleration[i] = (*this)(0.5, 6),
      l.jerk[i] = (*this)(1, 20);
    return l;
  }
};

TEST(Solve, seven_axes_end_together_inside_the_limits) {
  const std::uint64_t seed = 21;
  Draw draw{std::mt19937_64(seed)};
  int blocked = 0;
  for (int k = 0; k < 20000; ++k) {
    const KinematicLimits l = draw.limits(7);
    const MotionState3 from = draw.state(l, 0.6), to = draw.state(l, 0.6);
    const Solution s = solve(from, to, l);
    ASSERT_TRUE(s.ok()) << s.reason << " seed " << seed << " case " << k;
    ASSERT_EQ(why_not_within(s.trajectory, l, 1e-9), "") << "seed " << seed << " case " << k;
    ASSERT_EQ(s.excess, 0);
    const MotionState3 end = final_state(s.trajectory);
    ASSERT_LT((end.position - to.position).lpNorm<Eigen::Infinity>(), 1e-9);
    ASSERT_LT((end.velocity - to.velocity).lpNorm<Eigen::Infinity>(), 1e-9);
    ASSERT_LT((end.acceleration - to.acceleration).lpNorm<Eigen::Infinity>(), 1e-9);
    const double slowest = *std::max_element(s.min_durations.begin(), s.min_durations.end());
    ASSERT_GE(s.trajectory.duration(), slowest * (1 - 1e-12));
    blocked += s.trajectory.duration() > slowest * (1 + 1e-9);
  }
  EXPECT_GT(blocked, 100);
}

TEST(Solve, refuses_what_it_cannot_do) {
  const KinematicLimits l{VectorXd::Ones(2), VectorXd::Ones(2), VectorXd::Ones(2)};
  const MotionState3 a = rest_state(VectorXd::Zero(2)), b = rest_state(VectorXd::Ones(2));
  EXPECT_NE(solve(a, rest_state(VectorXd::Ones(3)), l).reason, "");
  EXPECT_NE(solve(a, b, {VectorXd::Ones(2), VectorXd::Zero(2), VectorXd::Ones(2)}).reason, "");
  EXPECT_NE(solve(a, b, l, Sync::time, 0.1).reason, "");
  EXPECT_NE(solve(a, b, l, Sync::time, std::nan("")).reason, "");
  MotionState3 moving = b;
  moving.velocity[0] = 0.5;
  moving.position[1] = 9;
  EXPECT_NE(solve(a, moving, l, Sync::none).reason, "");
  EXPECT_EQ(solve(a, b, l, Sync::none).reason, "");
  EXPECT_NEAR(solve(a, b, l, Sync::time, 30.0).trajectory.duration(), 30.0, 1e-9);
}

TEST(Edit, cut_and_append_give_the_same_motion) {
  Draw draw{std::mt19937_64(22)};
  for (int k = 0; k < 300; ++k) {
    const KinematicLimits l = draw.limits(3);
    const Trajectory whole = solve(draw.state(l, 0.5), draw.state(l, 0.5), l).trajectory;
    const double T = whole.duration(), t = draw(0, 1) * T;
    Trajectory joined = cut(whole, 0, t);
    ASSERT_NEAR(joined.duration(), t, 1e-9);
    append(joined, cut(whole, t, T));
    const Trajectory alike = split_alike(whole);
    for (const AxisTrajectory& axis : alike.axes)
      ASSERT_EQ(axis.segments.size(), alike.axes[0].segments.size());
    for (int i = 0; i <= 20; ++i) {
      const MotionState3 x = whole.at(T * i / 20), y = joined.at(T * i / 20),
                         z = alike.at(T * i / 20);
      ASSERT_LT((x.position - y.position).norm() + (x.velocity - y.velocity).norm(), 1e-9);
      ASSERT_LT((x.position - z.position).norm() + (x.velocity - z.velocity).norm(), 1e-8);
    }
  }
}

TEST(Edit, shifted_reversed_stretched_and_tabled_motions_are_the_same_way) {
  Draw draw{std::mt19937_64(27)};
  for (int k = 0; k < 300; ++k) {
    const KinematicLimits l = draw.limits(3);
    const Trajectory whole = solve(draw.state(l, 0.5), draw.state(l, 0.5), l).trajectory;
    const Trajectory rest =
        solve(rest_state(VectorXd::Zero(3)), rest_state(VectorXd::Ones(3)), l).trajectory;
    const double T = whole.duration(), by = draw(0, 2), factor = draw(0.2, 5);
    const Trajectory late = shifted(rest, by), early = shifted(whole, -by), back = reversed(whole),
                     slow = stretched(whole, factor), tabled = to_trajectory(SegmentTable(whole));
    ASSERT_NEAR(late.duration(), rest.duration() + by, 1e-9);
    ASSERT_NEAR(slow.duration(), T * factor, 1e-9 * factor * T);
    ASSERT_EQ(back.axes[0].segments.size(), whole.axes[0].segments.size());
    for (int i = 0; i <= 20; ++i) {
      const double t = T * i / 20;
      const MotionState3 x = whole.at(t), b = back.at(T - t), s = slow.at(t * factor),
                         m = tabled.at(t);
      ASSERT_LT((x.position - b.position).norm() + (x.velocity + b.velocity).norm() +
                    (x.acceleration - b.acceleration).norm(),
                1e-7);
      ASSERT_LT((x.position - s.position).norm() + (x.velocity - s.velocity * factor).norm(), 1e-8);
      ASSERT_LT((x.acceleration - s.acceleration * factor * factor).norm(), 1e-8);
      ASSERT_LT((x.position - m.position).norm() + (x.velocity - m.velocity).norm() +
                    (x.acceleration - m.acceleration).norm(),
                1e-8);
      ASSERT_LT((late.at(t + by).position - rest.at(t).position).norm() +
                    late.at(std::min(t, by)).position.norm() * (t < by),
                1e-9);
      if (t >= by) {
        ASSERT_LT((early.at(t - by).position - x.position).norm(), 1e-9);
      }
    }
  }
}

TEST(ThreeSegment, meets_both_ends) {
  Draw draw{std::mt19937_64(23)};
  for (int k = 0; k < 10000; ++k) {
    const AxisState a{draw(-1, 1), draw(-1, 1), draw(-1, 1)},
        b{draw(-1, 1), draw(-1, 1), draw(-1, 1)};
    AxisState s = a;
    for (const Segment& g : three_segment(a, b, draw(0.2, 3))) s = advanced(s, g.duration, g.jerk);
    ASSERT_NEAR(s.position, b.position, 1e-12);
    ASSERT_NEAR(s.velocity, b.velocity, 1e-12);
    ASSERT_NEAR(s.acceleration, b.acceleration, 1e-11);
  }
}

TEST(JerkLimitedStop, comes_to_rest_in_the_measured_time) {
  Draw draw{std::mt19937_64(24)};
  for (int k = 0; k < 10000; ++k) {
    const AxisLimits l{1, draw(0.5, 4), draw(1, 20)};
    const AxisState start{draw(-1, 1), draw(-1, 1), draw(-1.5, 1.5) * l.acceleration};
    const StopMeasure m = measure_stop(start.velocity, start.acceleration, l.acceleration, l.jerk);
    JerkLimitedStop stop;
    stop.init(start, l);
    AxisState last = start;
    double t = 0;
    while (!stop.finished()) {
      const AxisState s = stop.step(0.001);
      t += 0.001;
      ASSERT_LE(std::abs(s.acceleration - last.acceleration), l.jerk * 0.001 * (1 + 1e-6) + 1e-12);
      ASSERT_LE(std::abs(s.acceleration),
                std::max(std::abs(start.acceleration), l.acceleration) * (1 + 1e-9));
      last = s;
      ASSERT_LT(t, m.duration + 0.01);
    }
    ASSERT_NEAR(t, m.duration, 0.0011);
    ASSERT_NEAR(stop.state().position - start.position, m.distance, 1e-9);
    ASSERT_EQ(stop.state().velocity, 0);
  }
}

TEST(JerkLimitedStop, critical_movement_ends_at_its_end_for_small_speeds_too) {
  Draw draw{std::mt19937_64(26)};
  for (int k = 0; k < 100000; ++k) {
    const double A = draw(0.5, 4), J = draw(1, 20);
    AxisState s{0, draw(-1, 1) * std::pow(10, draw(-4, 0)),
                draw(-1, 1) * A * std::pow(10, draw(-4, 0))};
    AxisProfile p;
    critical_movement({s.velocity, s.acceleration}, {}, A, J, p);
    for (int i = 0; i < p.count; ++i)
      s = advanced(s, p.segments[static_cast<std::size_t>(i)].duration,
                   p.segments[static_cast<std::size_t>(i)].jerk);
    ASSERT_NEAR(s.velocity, 0, 1e-9);
    ASSERT_NEAR(s.acceleration, 0, 1e-9);
  }
}

TEST(Limits, extremes_are_exact) {
  Draw draw{std::mt19937_64(25)};
  for (int k = 0; k < 300; ++k) {
    const KinematicLimits l = draw.limits(2);
    const Trajectory whole = solve(draw.state(l, 0.6), draw.state(l, 0.6), l).trajectory;
    for (int i = 0; i < 2; ++i) {
      const AxisExtremes e = extremes(whole.axes[i]);
      double low = 1e9, high = -1e9, v = 0;
      for (int j = 0; j <= 4000; ++j) {
        const MotionState3 s = whole.at(whole.duration() * j / 4000);
        low = std::min(low, s.position[i]), high = std::max(high, s.position[i]),
        v = std::max(v, std::abs(s.velocity[i]));
      }
      ASSERT_LE(e.lowest, low + 1e-12);
      ASSERT_GE(e.highest, high - 1e-12);
      ASSERT_NEAR(e.lowest, low, 1e-4);
      ASSERT_NEAR(e.highest, high, 1e-4);
      ASSERT_NEAR(e.velocity, v, 1e-2);
    }
  }
  Trajectory bad = standing(VectorXd::Zero(1));
  const KinematicLimits one{VectorXd::Ones(1), VectorXd::Ones(1), VectorXd::Ones(1)};
  EXPECT_EQ(why_not_within(bad, one, 0), "");
  bad.axes[0].segments = {{1.0, 1.5}};
  EXPECT_NE(why_not_within(bad, one, 0.1), "");
  bad.axes[0].segments = {{std::nan(""), 0.5}};
  EXPECT_NE(why_not_within(bad, one, 0.1), "");
}

}  // namespace
}  // namespace handsel::trajectory_test
