// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/switch.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "common/trajectory/setpoint_filter.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "common/trajectory/time_scaling.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/motion_draw.hpp"

namespace handsel::switch_test {
namespace {

using Eigen::VectorXd;

struct Draw : test::Draw {
  /// In motion, inside the limits for good.
  MotionState3 state(const KinematicLimits& l) {
    const int n = static_cast<int>(l.velocity.size());
    MotionState3 s{vector(n, -1, 1), vector(n, -0.6, 0.6).cwiseProduct(l.velocity),
                   vector(n, -1, 1)};
    for (int i = 0; i < n; ++i)
      s.acceleration[i] *=
          std::min(0.9 * l.acceleration[i], std::sqrt(0.6 * l.velocity[i] * l.jerk[i]));
    return s;
  }
  Trajectory path(const KinematicLimits& guard) {
    const int n = static_cast<int>(guard.velocity.size());
    std::vector<VectorXd> nodes;
    for (int i = 0; i < 3; ++i) nodes.push_back(vector(n, -1, 1));
    return smooth(nodes, test::scaled(guard, 1 / 1.1)).trajectory;
  }
};

double distance(const MotionState3& x, const MotionState3& y) {
  return std::max({(x.position - y.position).lpNorm<Eigen::Infinity>(),
                   (x.velocity - y.velocity).lpNorm<Eigen::Infinity>(),
                   (x.acceleration - y.acceleration).lpNorm<Eigen::Infinity>()});
}

TEST(Switch, leads_from_any_motion_onto_a_trajectory_that_starts_elsewhere_or_moving) {
  const std::uint64_t seed = 51;
  Draw draw{std::mt19937_64(seed)};
  for (int k = 0; k < 400; ++k) {
    const KinematicLimits guard = draw.limits(1 + k % 7);
    Trajectory next = draw.path(guard);
    if (k % 2) next = cut(next, draw(0, 0.8) * next.duration(), next.duration());
    const MotionState3 now = draw.state(guard);
    const Switched s = switch_to(now, next, guard);
    ASSERT_TRUE(s.ok()) << s.reason << " seed " << seed << " case " << k;
    ASSERT_EQ(why_not_within(s.trajectory, guard, 1e-6), "") << "seed " << seed << " case " << k;
    ASSERT_LT(distance(s.trajectory.at(0), now), 1e-12);
    ASSERT_LT(distance(s.trajectory.at(s.connecting), next.at(s.joins_at)), 1e-7);
    ASSERT_LT(distance(final_state(s.trajectory), final_state(next)), 1e-7);
    ASSERT_NEAR(s.trajectory.duration(), s.connecting + next.duration() - s.joins_at, 1e-9);
    const KinematicLimits planning{guard.velocity / 1.1, guard.acceleration / 1.1,
                                   guard.jerk / 1.1};
    const Solution direct = solve(now, final_state(next), planning);
    if (direct.ok()) {
      ASSERT_LE(s.trajectory.duration(), direct.trajectory.duration() + 1e-9);
    }
  }
}

TEST(Switch, meets_a_trajectory_that_runs_already) {
  const std::uint64_t seed = 52;
  Draw draw{std::mt19937_64(seed)};
  int sooner = 0, looked = 0;
  SwitchSettings settings;
  settings.on_clock = true;
  for (int k = 0; k < 200; ++k) {
    const KinematicLimits guard = draw.limits(1 + k % 7),
                          planning{guard.velocity / 1.1, guard.acceleration / 1.1,
                                   guard.jerk / 1.1};
    const Trajectory next = draw.path(guard);
    const MotionState3 now = draw.state(planning);
    const Switched s = switch_to(now, next, guard, settings);
    ASSERT_TRUE(s.ok()) << s.reason << " seed " << seed << " case " << k;
    ASSERT_EQ(why_not_within(s.trajectory, guard, 1e-6), "");
    ASSERT_NEAR(s.connecting, s.joins_at, 1e-9);
    for (double t = s.joins_at; t < next.duration(); t += 0.05)
      ASSERT_LT(distance(s.trajectory.at(t), next.at(t)), 1e-6);
    ASSERT_LT(distance(final_state(s.trajectory), final_state(next)), 1e-7);
    for (int i = 1; i < 50; ++i) {
      const double t = s.joins_at * i / 50;
      const Solution earlier = solve(now, next.at(t), planning, Sync::time, t);
      sooner += earlier.ok() && earlier.excess == 0;
      ++looked;
    }
  }
  printf("earlier meetings left out: %d of %d instants looked at\n", sooner, looked);
  EXPECT_LT(sooner, looked / 50);
}

TEST(Switch, nothing_leads_over_where_only_rounding_is_between) {
  const std::uint64_t seed = 57;
  Draw draw{std::mt19937_64(seed)};
  SwitchSettings at_its_beginning;
  at_its_beginning.last = 0;
  for (int k = 0; k < 200; ++k) {
    const KinematicLimits guard = draw.limits(1 + k % 7);
    const int n = static_cast<int>(guard.velocity.size());
    const Trajectory first = draw.path(guard);
    const double leave = draw(0.1, 0.9) * first.duration();
    const Trajectory next = cut(first, leave, first.duration());
    MotionState3 now = first.at(leave);
    for (VectorXd* part : {&now.position, &now.velocity, &now.acceleration})
      *part += 1e-12 * draw.vector(n, -1, 1);
    const Switched s = switch_to(now, next, guard, at_its_beginning);
    ASSERT_TRUE(s.ok()) << s.reason << " seed " << seed << " case " << k;
    ASSERT_EQ(s.connecting, 0) << "seed " << seed << " case " << k;
    ASSERT_NEAR(s.trajectory.duration(), next.duration(), 1e-9);
    TimeScaling law;
    ASSERT_EQ(law.init(first, guard), "");
    for (int i = 0; i < 20; ++i) law.advance(0.001);
    ASSERT_EQ(law.switch_at(leave, SegmentTable(next), at_its_beginning), SwitchOutcome::ok);
    ASSERT_NEAR(law.duration(), first.duration(), 1e-9) << "seed " << seed << " case " << k;
  }
}

TEST(Switch, says_why_not) {
  const KinematicLimits guard{VectorXd::Ones(2), VectorXd::Ones(2), VectorXd::Ones(2)};
  const Trajectory next = straight_motion(VectorXd::Zero(2), VectorXd::Ones(2),
                                          {guard.velocity / 1.1, guard.acceleration, guard.jerk});
  MotionState3 now = rest_state(VectorXd::Zero(2));
  EXPECT_EQ(switch_to(now, next, guard).reason, "");
  EXPECT_NE(switch_to(rest_state(VectorXd::Zero(3)), next, guard).reason, "");
  EXPECT_NE(switch_to(now, {}, guard).reason, "");
  EXPECT_NE(switch_to(now, next, {guard.velocity / 2, guard.acceleration, guard.jerk}).reason, "");
  now.velocity[1] = 1.1;
  EXPECT_EQ(switch_to(now, next, guard).reason, reason(SwitchOutcome::start_beyond_limits));
  now.velocity[1] = 0.9;
  now.acceleration[1] = 0.9;
  EXPECT_EQ(switch_to(now, next, guard).reason, reason(SwitchOutcome::start_beyond_limits));
  now.velocity[1] = std::nan("");
  EXPECT_EQ(switch_to(now, next, guard).reason, reason(SwitchOutcome::not_finite));
  TrajectorySwitch connection(2);
  now.velocity[1] = 0;
  EXPECT_EQ(connection.plan(now, SegmentTable(next),
                            {guard.velocity * 0, guard.acceleration, guard.jerk}, {}),
            SwitchOutcome::bad_limits);
  EXPECT_EQ(connection.plan(now, SegmentTable(), guard, {}), SwitchOutcome::wrong_size);
  TimeScaling idle;
  EXPECT_EQ(idle.switch_to(SegmentTable(next)), SwitchOutcome::wrong_size);
}

TEST(Switch, keeps_the_path_behind_and_the_own_time_of_what_runs) {
  Draw draw{std::mt19937_64(53)};
  for (int k = 0; k < 15; ++k) {
    const KinematicLimits guard = draw.limits(3);
    const Trajectory first = draw.path(guard), next = draw.path(guard);
    TimeScaling law;
    ASSERT_EQ(law.init(first, guard), "");
    law.set_target(k % 2 ? 0.5 : 1);
    for (double until = draw(0.2, 0.7) * first.duration(); law.time() < until;) law.advance(0.001);
    while (law.switch_to(SegmentTable(next)) != SwitchOutcome::ok) law.advance(0.001);
    const double at = law.time();
    while (law.own_time() < law.joined_at()) law.advance(0.001);
    law.set_target(1);
    for (int i = 0; i < 300; ++i) law.advance(0.001);
    ASSERT_LT((law.state().position - next.at(law.own_time()).position).norm(), 1e-7);
    law.set_target(-1);
    while (law.time() > at / 2) law.advance(0.001);
    ASSERT_LT((law.state().position - first.at(law.time()).position).norm(), 1e-7);
    law.set_target(1);
    for (int i = 0; i < 60000 && !law.finished(); ++i) law.advance(0.001);
    ASSERT_LT((law.state().position - final_state(next).position).norm(), 1e-7);
  }
}

TEST(Switch, is_planned_ahead_and_taken_back_without_a_trace) {
  Draw draw{std::mt19937_64(54)};
  for (int k = 0; k < 15; ++k) {
    const KinematicLimits guard = draw.limits(3);
    const Trajectory first = draw.path(guard), next = draw.path(guard);
    TimeScaling law, other;
    ASSERT_EQ(law.init(first, guard), "");
    ASSERT_EQ(other.init(first, guard), "");
    const double leave = draw(0.3, 0.9) * first.duration();
    for (TimeScaling* l : {&law, &other}) {
      l->set_target(0.7);
      for (int i = 0; i < 150; ++i) l->advance(0.001);
    }
    ASSERT_EQ(law.switch_at(leave, SegmentTable(next)), SwitchOutcome::ok);
    EXPECT_DOUBLE_EQ(law.switched_at(), leave);
    law.undo_switch();
    EXPECT_EQ(law.duration(), other.duration());
    for (int i = 0; i < 100; ++i) {
      law.advance(0.001);
      other.advance(0.001);
      ASSERT_EQ(law.state().position, other.state().position);
    }
    ASSERT_EQ(law.switch_at(leave, SegmentTable(next)), SwitchOutcome::ok);
    while (law.time() < leave) {
      ASSERT_LT((law.state().position - first.at(law.time()).position).norm(), 1e-9);
      law.advance(0.001);
    }
    law.set_target(-0.5);
    while (law.time() > leave / 2) law.advance(0.001);
    law.set_target(1);
    for (int i = 0; i < 60000 && !law.finished(); ++i) law.advance(0.001);
    ASSERT_LT((law.state().position - final_state(next).position).norm(), 1e-7);
  }
}

TEST(Switch, what_may_not_run_back_stands_when_asked_to) {
  Draw draw{std::mt19937_64(56)};
  for (int k = 0; k < 30; ++k) {
    const KinematicLimits guard = draw.limits(3);
    const Trajectory first = draw.path(guard), next = draw.path(guard);
    TimeScaling law;
    ASSERT_EQ(law.init(first, guard), "");
    for (double until = draw(0.2, 0.7) * first.duration(); law.time() < until;) law.advance(0.001);
    if (law.start_from(MotionState3(law.state()), SegmentTable(next)) != SwitchOutcome::ok)
      continue;
    for (int i = 0; i < 200; ++i) law.advance(0.001);
    for (const double target : {0.3, 1e-5, 0.0}) {
      law.set_target(target);
      for (int i = 0; i < 3000; ++i) law.advance(0.001);
    }
    ASSERT_TRUE(law.standing() || law.finished()) << k << ": alpha " << law.alpha();
  }
}

TEST(Replan, does_not_jump_when_start_and_end_accelerate_alike) {
  const std::uint64_t seed = 55;
  Draw draw{std::mt19937_64(seed)};
  const double dt = 0.004;
  int jumps = 0, plain = 0;
  const int cases = 1500;
  for (int k = 0; k < cases; ++k) {
    const KinematicLimits limits = draw.limits(1);
    const AxisLimits l = limits_of(limits, 0);
    const auto any = [&] {
      const double v = draw(-0.9, 0.9) * l.velocity;
      return AxisState{
          draw(-1, 1), v,
          draw(-0.9, 0.9) *
              std::min(l.acceleration, std::sqrt(2 * l.jerk * (l.velocity - std::abs(v))))};
    };
    AxisState s = any();
    const AxisState end = any();
    AxisProfile p;
    ASSERT_EQ(replan_axis(s, end, l, p), AxisOutcome::ok);
    for (double left = p.duration() - dt; left > dt; left -= dt) {
      double t = dt;
      for (int i = 0; i < p.count && t > 0; ++i) {
        const double step = std::min(t, p.segments[i].duration);
        s = advanced(s, step, p.segments[i].jerk);
        t -= step;
      }
      AxisProfile q;
      plain += solve_axis(s, end, l, q) == AxisOutcome::ok && q.duration() > left + 1e-3;
      ASSERT_EQ(replan_axis(s, end, l, p), AxisOutcome::ok);
      ASSERT_LE(rate_extremes(s, p.segments.data(), p.count).jerk, l.jerk * (1 + 1e-6));
      if (p.duration() > left + 1e-3) {
        ++jumps;
        break;
      }
    }
  }
  printf("%d jumps in %d motions planned anew each tick; solve_axis at the same states: %d\n",
         jumps, cases, plain);
  EXPECT_LE(jumps, 1);
}

TEST(Switch, nothing_that_runs_in_a_cycle_allocates) {
  Draw draw{std::mt19937_64(54)};
  const KinematicLimits guard = draw.limits(7);
  const SegmentTable next(draw.path(guard)), other(draw.path(guard));
  TimeScaling law;
  ASSERT_EQ(law.init(draw.path(guard), guard), "");
  SynchronisedAxes axes(7);
  const MotionState3 a = draw.state(guard), b = draw.state(guard);
  JerkLimitedStop stop;
  SetpointFilter filter({0, 0, 0}, {1, 2, 10});
  AxisProfile profile;
  MotionState3 out = rest_state(VectorXd::Zero(7));
  SwitchSettings clock;
  clock.on_clock = true;
  const std::uint64_t before = test::allocations();
  int switched = 0, cursor = 0;
  for (int i = 0; i < 6000; ++i) {
    if (i % 400 == 0) law.set_target(0.1 * (i / 400 % 21) - 1);
    if (i % 700 == 300)
      switched += law.switch_to(i % 1400 == 300 ? next : other,
                                i % 2100 == 300 ? clock : SwitchSettings{}) == SwitchOutcome::ok;
    if (i % 1700 == 900) switched += law.start_from(law.state(), next) == SwitchOutcome::ok;
    law.advance(0.001);
    if (i % 50 == 0) {
      axes.solve(a, b, guard);
      const AxisLimits l = limits_of(guard, i % 7);
      solve_axis({0.1, 0.1, 0.2}, {1, -0.1, 0.1}, l, profile);
      replan_axis({0.1, 0.1, 0.2}, {1, -0.1, 0.1}, l, profile);
      stop.init({0, 0.2, 0.1}, l);
    }
    stop.step(0.001);
    filter.toward({0.3, 0.2, 0.1}, 0.001);
    filter.toward_velocity(0.2, 0.1, 0.001);
    next.evaluate(0.001 * i, cursor, out);
  }
  EXPECT_EQ(test::allocations() - before, 0u);
  EXPECT_GT(switched, 8);
}

}  // namespace
}  // namespace handsel::switch_test
