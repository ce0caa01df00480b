// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/time_scaling.hpp"

#include <gtest/gtest.h>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "common/trajectory/setpoint_filter.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "tests/support/motion_draw.hpp"

namespace handsel::time_scaling_test {
namespace {

using Eigen::VectorXd;
using test::Draw;
using test::runs;
using test::scaled;

TEST(TimeScaling, every_step_is_within_the_guard_whatever_is_asked_for) {
  const std::uint64_t seed = 31;
  Draw draw{std::mt19937_64(seed)};
  double largest = 0;
  for (int k = 0; k < runs(40); ++k) {
    const int n = 7;
    const KinematicLimits guard = draw.limits(n);
    Trajectory t = solve(rest_state(draw.vector(n, -1, 1)), rest_state(draw.vector(n, -1, 1)),
                         scaled(guard, 1 / 1.1))
                       .trajectory;
    TimeScaling law;
    ASSERT_EQ(law.init(t, guard), "");
    MotionState3 last = law.state();
    double until = 0;
    for (int i = 0; i < 4000 && !law.finished(); ++i) {
      if (i * 0.001 >= until) {
        until += draw(0.0, 0.8) * draw(0, 1);
        const double pick = draw(0, 1);
        law.set_target(pick < 0.25 ? 0 : pick < 0.5 ? 1 : draw(-1, 1));
      }
      const double alpha = law.alpha();
      law.advance(0.001);
      for (int a = 0; a < n; ++a) {
        const double v = std::abs(law.state().velocity[a]) / guard.velocity[a];
        const double acc = std::abs(law.state().acceleration[a]) / guard.acceleration[a];
        const double j = std::abs(law.jerk()[a]) / guard.jerk[a];
        const double seen =
            std::abs(law.state().acceleration[a] - last.acceleration[a]) / 0.001 / guard.jerk[a];
        largest = std::max({largest, v, acc, j, seen});
        ASSERT_LE(std::max({v, acc, j, seen}), 1 + 1e-6)
            << "seed " << seed << " run " << k << " step " << i << " axis " << a << " shares " << v
            << ' ' << acc << ' ' << j << ' ' << seen;
        const double moved = last.position[a] + 0.001 * last.velocity[a];
        ASSERT_NEAR(law.state().position[a], moved, 0.5e-6 * guard.acceleration[a] * 1.01);
      }
      ASSERT_LE(std::abs(law.alpha()), 1 + 1e-9);
      ASSERT_LT(std::abs(law.alpha() - alpha), 0.03);
      last = law.state();
    }
  }
  RecordProperty("largest_share", std::to_string(largest));
}

TEST(TimeScaling, corners_that_use_the_whole_guard_are_kept_too) {
  const std::uint64_t seed = 34;
  Draw draw{std::mt19937_64(seed)};
  for (int k = 0; k < runs(25); ++k) {
    const int n = 7;
    const KinematicLimits guard = draw.limits(n);
    std::vector<VectorXd> nodes;
    for (int i = 0; i < 4; ++i) nodes.push_back(draw.vector(n, -1, 1));
    const SmoothResult smoothed = smooth(nodes, scaled(guard, 1 / 1.1));
    ASSERT_TRUE(smoothed.ok()) << smoothed.reason;
    TimeScaling law;
    ASSERT_EQ(law.init(smoothed.trajectory, guard), "");
    double until = 0;
    for (int i = 0; i < 6000 && !law.finished(); ++i) {
      if (i * 0.001 >= until) {
        until += draw(0.0, 1.0) * draw(0, 1);
        law.set_target(draw(0, 1) < 0.3 ? 0 : draw(-1, 1));
      }
      law.advance(0.001);
      for (int a = 0; a < n; ++a) {
        ASSERT_LE(std::abs(law.state().velocity[a]), guard.velocity[a] * (1 + 1e-6))
            << "seed " << seed << " run " << k << " step " << i;
        ASSERT_LE(std::abs(law.state().acceleration[a]), guard.acceleration[a] * (1 + 1e-6))
            << "seed " << seed << " run " << k << " step " << i;
        ASSERT_LE(std::abs(law.jerk()[a]), guard.jerk[a] * (1 + 1e-6))
            << "seed " << seed << " run " << k << " step " << i << " axis " << a;
      }
    }
  }
}

TEST(TimeScaling, stops_nearly_as_fast_as_the_axes_could) {
  Draw draw{std::mt19937_64(32)};
  double along = 0, own = 0, worst = 0;
  int stops = 0;
  for (int k = 0; k < 30; ++k) {
    const int n = 7;
    const KinematicLimits guard{VectorXd::Constant(n, 0.475 * 1.1),
                                VectorXd::Constant(n, 0.95 * 1.1),
                                VectorXd::Constant(n, 2.85 * 1.1)};
    const Trajectory t = solve(rest_state(draw.vector(n, -2, 2)), rest_state(draw.vector(n, -2, 2)),
                               scaled(guard, 1 / 1.1))
                             .trajectory;
    TimeScaling law;
    ASSERT_EQ(law.init(t, guard), "");
    const double at = draw(0.1, 0.7) * t.duration();
    while (law.time() < at) law.advance(0.001);
    const double needed = stop_trajectory(law.state(), guard).duration();
    law.set_target(0);
    double time = 0;
    while (!law.standing() && !law.finished() && time < 8) law.advance(0.001), time += 0.001;
    along += time;
    own += needed;
    worst = std::max(worst, time);
    ++stops;
  }
  RecordProperty("mean_stop_s", std::to_string(along / stops));
  RecordProperty("mean_own_stop_s", std::to_string(own / stops));
  printf("stop along the path: mean %.3f s, worst %.3f s; every axis alone: mean %.3f s\n",
         along / stops, worst, own / stops);
  EXPECT_LT(along / stops, 2.0 * own / stops);
}

TEST(TimeScaling, holds_resumes_and_runs_back) {
  const KinematicLimits guard{VectorXd::Ones(2), VectorXd::Ones(2) * 2, VectorXd::Ones(2) * 8};
  const VectorXd a = VectorXd::Zero(2), b = (VectorXd(2) << 1.0, -0.4).finished();
  const Trajectory t = solve(rest_state(a), rest_state(b), scaled(guard, 0.9)).trajectory;
  TimeScaling law;
  ASSERT_EQ(law.init(t, guard), "");
  for (int i = 0; i < 600; ++i) law.advance(0.001);
  law.set_target(0);
  for (int i = 0; i < 3000; ++i) law.advance(0.001);
  EXPECT_TRUE(law.standing());
  EXPECT_EQ(law.state().velocity.norm(), 0);
  law.set_target(-1);
  for (int i = 0; i < 5000; ++i) law.advance(0.001);
  EXPECT_TRUE(law.back_at_start());
  EXPECT_LT((law.state().position - a).norm(), 1e-9);
  law.set_target(1);
  for (int i = 0; i < 20000 && !law.finished(); ++i) law.advance(0.001);
  EXPECT_TRUE(law.finished());
  EXPECT_LT((law.state().position - b).norm(), 1e-9);
}

TEST(TimeScaling, refuses_what_it_cannot_run) {
  const KinematicLimits guard{VectorXd::Ones(1), VectorXd::Ones(1), VectorXd::Ones(1)};
  Trajectory t =
      solve(rest_state(VectorXd::Zero(1)), rest_state(VectorXd::Ones(1)), guard).trajectory;
  TimeScaling law;
  EXPECT_EQ(law.init(t, guard), "");
  EXPECT_NE(law.init(t, scaled(guard, 0.9)), "");
  EXPECT_NE(law.init(cut(t, 0, 0.5), guard), "");
  EXPECT_NE(law.init({}, guard), "");
  EXPECT_EQ(law.init(t, guard), "");
  law.set_target(std::nan(""));
  EXPECT_EQ(law.target(), 0);
}

TEST(SetpointFilter, stays_within_limits_and_arrives) {
  Draw draw{std::mt19937_64(33)};
  for (int k = 0; k < 300; ++k) {
    const AxisLimits l{draw(0.2, 2), draw(0.3, 5), draw(1, 30)};
    SetpointFilter filter({0, 0, 0}, l);
    double wanted = 0, a_wanted = 0;
    for (int i = 0; i < 3000; ++i) {
      if (i % 500 == 0) wanted = draw(-2, 2), a_wanted = i == 2500 ? 0 : draw(-1, 1);
      const AxisState before = filter.state(),
                      after = filter.toward_velocity(wanted, a_wanted, 0.002);
      ASSERT_LE(std::abs(after.velocity), l.velocity * (1 + 1e-6));
      ASSERT_LE(std::abs(after.acceleration), l.acceleration * (1 + 1e-9));
      ASSERT_LE(std::abs(after.acceleration - before.acceleration), l.jerk * 0.002 * (1 + 1e-6));
    }
  }
}

TEST(SetpointFilter, catches_a_moving_target) {
  SetpointFilter filter({0, 0, 0}, {1, 2, 10});
  AxisState target{0.5, 0.3, 0};
  for (int i = 0; i < 4000; ++i) {
    target.position += 0.3 * 0.001;
    const AxisState before = filter.state(), after = filter.toward(target, 0.001);
    ASSERT_LE(std::abs(after.velocity), 1 + 1e-6);
    ASSERT_LE(std::abs(after.acceleration - before.acceleration), 10 * 0.001 * (1 + 1e-6));
  }
  EXPECT_NEAR(filter.state().position, target.position, 1e-3);
  EXPECT_NEAR(filter.state().velocity, 0.3, 1e-3);
}

TEST(SetpointFilter, catches_what_a_hand_holds_and_stays_on_it) {
  const std::uint64_t seed = 35;
  Draw draw{std::mt19937_64(seed)};
  const double dt = 0.001;
  double worst = 0, slowest = 0;
  for (int k = 0; k < 100; ++k) {
    const AxisLimits l{draw(0.5, 2), draw(2, 5), draw(10, 30)};
    // A swaying hand within the limits; in every other case the target has the noise of a camera.
    const double w = draw(0.5, 1.5),
                 size = 0.4 * std::min(l.velocity / w, l.acceleration / (w * w)),
                 phase = draw(0, 6), noise = k % 2 ? 1e-4 : 0;
    SetpointFilter filter({draw(-1, 1), 0, 0}, l);
    double caught = -1;
    for (int i = 0; i < 8000; ++i) {
      const double t = i * dt, s = w * t + phase;
      const AxisState target{size * std::sin(s) + noise * draw(-1, 1), size * w * std::cos(s),
                             -size * w * w * std::sin(s)};
      const AxisState before = filter.state(), after = filter.toward(target, dt);
      ASSERT_LE(std::abs(after.velocity), l.velocity * (1 + 1e-6))
          << "seed " << seed << " case " << k << " tick " << i;
      ASSERT_LE(std::abs(after.acceleration), l.acceleration * (1 + 1e-6))
          << "seed " << seed << " case " << k << " tick " << i;
      ASSERT_LE(std::abs(after.acceleration - before.acceleration), l.jerk * dt * (1 + 1e-6));
      const double miss = std::abs(after.position - size * std::sin(s + w * dt));
      if (caught < 0 && miss < 1e-3) caught = t;
      if (caught >= 0 && t > caught + 1) worst = std::max(worst, miss);
    }
    ASSERT_GE(caught, 0) << "seed " << seed << " case " << k;
    slowest = std::max(slowest, caught);
  }
  printf("caught after at most %.2f s, then off by at most %.2e\n", slowest, worst);
  EXPECT_LT(worst, 2e-3);
}

TEST(SetpointFilter, numbers_that_are_none_lead_to_rest) {
  SetpointFilter filter({0, 0.5, 0}, {1, 2, 10});
  for (int i = 0; i < 3000; ++i) filter.toward({std::nan(""), std::nan(""), std::nan("")}, 0.001);
  EXPECT_NEAR(filter.state().velocity, 0, 1e-9);
  for (int i = 0; i < 3000; ++i) filter.toward_velocity(INFINITY, std::nan(""), 0.001);
  EXPECT_NEAR(filter.state().velocity, 0, 1e-9);
}

}  // namespace
}  // namespace handsel::time_scaling_test
