// SPDX-License-Identifier: Apache-2.0
// Seven axes from any state to any state, synchronised: every motion is checked at its exact
// extremes, a fraction of them against the slow solver of the tests. HANDSEL_CASES sets the number
// of problems, HANDSEL_SLOW at which interval the slow solver checks one.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/path/segment_table.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/three_segment.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/motion_cases.hpp"
#include "tests/support/oracles/ruckig_peer.hpp"
#include "tests/support/oracles/slow_min_time.hpp"

namespace handsel::trajectory_property_test {
namespace {

using Eigen::VectorXd;
using test::Case;
using test::Cases;

constexpr int kAxes = 7, kBatch = 8;
constexpr double kTight = 1e-9;

long setting(const char* name, long otherwise) {
  return std::getenv(name) ? std::atol(std::getenv(name)) : otherwise;
}

struct Problem {
  MotionState3 from{rest_state(VectorXd::Zero(kAxes))}, to{from};
  KinematicLimits limits{VectorXd::Ones(kAxes), VectorXd::Ones(kAxes), VectorXd::Ones(kAxes)};
  void set(int i, const Case& c) {
    from.position[i] = c.from.position, from.velocity[i] = c.from.velocity,
    from.acceleration[i] = c.from.acceleration;
    to.position[i] = c.to.position, to.velocity[i] = c.to.velocity,
    to.acceleration[i] = c.to.acceleration;
    limits.velocity[i] = c.limits.velocity, limits.acceleration[i] = c.limits.acceleration,
    limits.jerk[i] = c.limits.jerk;
  }
  Case axis(int i) const {
    return {{from.position[i], from.velocity[i], from.acceleration[i]},
            {to.position[i], to.velocity[i], to.acceleration[i]},
            {limits.velocity[i], limits.acceleration[i], limits.jerk[i]}};
  }
};

bool outside(const AxisState& s, const AxisLimits& l, double slack = 1e-9) {
  const double ahead = s.velocity + s.acceleration * std::abs(s.acceleration) / (2 * l.jerk);
  return std::abs(s.velocity) > l.velocity * (1 + slack) ||
         std::abs(s.acceleration) > l.acceleration * (1 + slack) ||
         std::abs(ahead) > l.velocity * (1 + slack);
}

Problem draw(Cases& cases) {
  Problem out;
  const int family = cases.pick(Cases::kFamilies + 1);
  const bool mixed = cases.pick(4) == 0;
  for (int i = 0; i < kAxes; ++i) {
    const int own = mixed ? cases.pick(Cases::kFamilies + 1) : family;
    Case c = cases.next(own == Cases::kFamilies ? 0 : own);
    if (own == Cases::kFamilies)
      c.from.velocity *= cases.uniform(1, 3), c.from.acceleration *= cases.uniform(1, 3);
    out.set(i, c);
  }
  return out;
}

struct Hash {
  std::uint64_t value{1469598103934665603ULL};
  void add(const Problem& p) {
    for (const VectorXd* all :
         {&p.from.position, &p.from.velocity, &p.from.acceleration, &p.to.position, &p.to.velocity,
          &p.to.acceleration, &p.limits.velocity, &p.limits.acceleration, &p.limits.jerk}) {
      for (const double x : *all)
        value = (value ^ std::bit_cast<std::uint64_t>(x)) * 1099511628211ULL;
    }
  }
};

/// Returns the fault of a motion that starts outside the limits: no excess may grow, and once
/// inside the motion must stay inside; empty: none.
std::string why_wrong_outside(const Case& c, const AxisProfile& p) {
  if (std::string why = test::why_wrong(c, p, false, 1e-8); !why.empty()) return why;
  AxisState s = c.from;
  int k = 0;
  for (; k < p.count && outside(s, c.limits); ++k) {
    s = advanced(s, p.segments[k].duration, p.segments[k].jerk);
    if (std::abs(p.segments[k].jerk) > c.limits.jerk * (1 + kTight)) return "jerk limit";
    if (std::abs(s.acceleration) >
        std::max(std::abs(c.from.acceleration), c.limits.acceleration) * (1 + kTight))
      return "acceleration";
  }
  const AxisExtremes e = extremes(s, p.segments.data() + k, p.count - k);
  if (e.velocity > c.limits.velocity * (1 + kTight) ||
      e.acceleration > c.limits.acceleration * (1 + kTight))
    return "leaves the limits again";
  return {};
}

struct Tally {
  long problems{}, axes{}, outside{}, blocked{}, slow{}, unknown{}, slow_blocked{}, slow_outside{},
      equal_to_slow{};
  double longest_against_slow{-1};
};

/// Returns the min common duration by the slow solver; negative: unknown.
double slow_common(const Problem& p) {
  std::vector<std::vector<double>> bounds(kAxes);
  double T = 0;
  for (int i = 0; i < kAxes; ++i) {
    const Case c = p.axis(i);
    AxisState start = c.from;
    const double inside = test::slow_way_inside(start, c.limits);
    if (inside < 0) return -1;
    bounds[i] = test::slow_bounds(start, c.to, c.limits, 200);
    if (bounds[i].size() == 2)
      bounds[i].insert(bounds[i].begin(),
                       bounds[i][0]);  // an isolated duration with a single motion
    if (bounds[i].size() % 2 == 0) return -1;
    for (double& t : bounds[i]) t += inside;
    T = std::max(T, bounds[i][0]);
  }
  for (bool grown = true; grown;) {
    grown = false;
    for (const std::vector<double>& b : bounds) {
      for (std::size_t k = 1; k + 1 < b.size(); k += 2) {
        if (T > b[k] * (1 + 1e-12) && T < b[k + 1] * (1 - 1e-12)) T = b[k + 1], grown = true;
      }
    }
  }
  return T;
}

/// The same one axis at a time.
double scalar_common(const Problem& p) {
  std::vector<AxisProblem> axes(kAxes);
  double T = 0;
  for (int i = 0; i < kAxes; ++i) {
    const Case c = p.axis(i);
    axes[i].init(c.from, c.to, c.limits);
    T = std::max(T, axes[i].minimum());
  }
  for (double last = -1; T > last;) {
    last = T;
    for (const AxisProblem& a : axes) T = std::max(T, a.earliest(T));
  }
  return T;
}

void check(const Problem& p, const SynchronisedBatch& solved, int k, Tally& tally, bool with_slow) {
  ASSERT_EQ(solved.outcome(k), AxisOutcome::ok)
      << reason(solved.outcome(k)) << " axis " << solved.axis(k) << ": " << p.axis(solved.axis(k));
  const double T = solved.duration(k);
  double min_duration = 0;
  int far_axes = 0;
  for (int i = 0; i < kAxes; ++i) {
    const Case c = p.axis(i);
    const AxisProfile& profile = solved.profile(k, i);
    min_duration = std::max(min_duration, solved.minimum(k, i));
    const bool far = outside(c.from, c.limits);
    far_axes += far;
    ASSERT_EQ(far ? why_wrong_outside(c, profile) : test::why_wrong(c, profile, true, kTight), "")
        << "axis " << i << ' ' << c << " T " << T;
    ASSERT_NEAR(profile.duration(), T, 1e-11 * T) << "axis " << i << ' ' << c;
  }
  ++tally.problems;
  tally.axes += kAxes;
  ASSERT_GE(T, min_duration * (1 - 1e-12));
  ASSERT_NEAR(T, scalar_common(p), kTight * T) << "differs from one axis at a time";
  const bool waited = T > min_duration * (1 + 1e-9);
  tally.blocked += waited;
  tally.outside += far_axes;
  if (!with_slow) return;
  const double slow = slow_common(p);
  if (slow < 0) {
    ++tally.unknown;
    return;
  }
  ++tally.slow;
  tally.slow_blocked += waited;
  tally.slow_outside += far_axes > 0;
  tally.equal_to_slow += std::abs(T - slow) <= 1e-9 * slow;
  tally.longest_against_slow = std::max(tally.longest_against_slow, slow > 0 ? T / slow - 1 : T);
  ASSERT_LE(T, slow * (1 + kTight) + 1e-12) << "longer than the slow solver";
}

#ifdef HANDSEL_RUCKIG
/// The last problems solved, by Ruckig too.
class Peer {
 public:
  void compare(const Problem& p, double T) {
    test::PeerProblem q;
    const VectorXd* all[9] = {&p.from.position,   &p.from.velocity,       &p.from.acceleration,
                              &p.to.position,     &p.to.velocity,         &p.to.acceleration,
                              &p.limits.velocity, &p.limits.acceleration, &p.limits.jerk};
    for (int k = 0; k < 9; ++k)
      std::copy(all[k]->begin(), all[k]->end(),
                k < 3   ? q.from[k]
                : k < 6 ? q.to[k - 3]
                        : q.limits[k - 6]);
    test::RuckigPeer peer({q});
    if (!peer.solve(0)) {
      ++unsolved_;
      return;
    }
    const double more = peer.duration() > 0 ? T / peer.duration() - 1 : T;
    equal_ += std::abs(more) <= kTight;
    shorter_ += more < -kTight;
    if (more > kTight) ++longer_, max_excess_ = std::max(max_excess_, more);
  }
  void print() const {
    std::printf(
        "Ruckig: %ld equal within 1e-9, ours shorter %ld, longer %ld (largest %.1e), %ld it does "
        "not solve\n",
        equal_, shorter_, longer_, max_excess_, unsolved_);
  }

 private:
  long equal_{}, shorter_{}, longer_{}, unsolved_{};
  double max_excess_{};
};
#else
struct Peer {
  void compare(const Problem&, double) {}
  void print() const {}
};
#endif

TEST(SevenAxes, end_together_inside_the_limits_and_as_soon_as_the_slow_solver) {
  const long count = setting("HANDSEL_CASES", 100000) / kBatch * kBatch,
             every = setting("HANDSEL_SLOW", 20);
  const std::uint64_t seed = 31;
  Cases cases(seed);
  SynchronisedBatch batch(kAxes, kBatch);
  SynchronisedAxes single(kAxes);
  std::vector<double> flat[9];
  for (auto& f : flat) f.resize(kAxes * kBatch);
  Tally tally;
  Hash hash;
  Peer peer;
  for (long first = 0; first < count; first += kBatch) {
    std::vector<Problem> problems;
    for (int k = 0; k < kBatch; ++k) {
      problems.push_back(draw(cases));
      const Problem& p = problems.back();
      hash.add(p);
      const VectorXd* all[9] = {&p.from.position,   &p.from.velocity,       &p.from.acceleration,
                                &p.to.position,     &p.to.velocity,         &p.to.acceleration,
                                &p.limits.velocity, &p.limits.acceleration, &p.limits.jerk};
      for (int j = 0; j < 9; ++j) std::copy_n(all[j]->data(), kAxes, flat[j].data() + k * kAxes);
    }
    const std::uint64_t before = test::allocations();
    batch.solve({flat[0].data(), flat[1].data(), flat[2].data(), flat[3].data(), flat[4].data(),
                 flat[5].data(), flat[6].data(), flat[7].data(), flat[8].data()},
                kBatch);
    const bool alone = single.solve(problems[0].from, problems[0].to, problems[0].limits);
    ASSERT_EQ(test::allocations(), before);
    ASSERT_TRUE(alone);
    ASSERT_NEAR(single.duration(), batch.duration(0), 1e-12 * single.duration())
        << "seed " << seed << " problem " << first;
    for (int k = 0; k < kBatch; ++k) {
      check(problems[static_cast<std::size_t>(k)], batch, k, tally,
            every > 0 && (first + k) % every == 0);
      peer.compare(problems[static_cast<std::size_t>(k)], batch.duration(k));
      if (::testing::Test::HasFatalFailure()) FAIL() << "seed " << seed << " problem " << first + k;
    }
  }
  std::printf(
      "%ld problems of 7 axes, inputs %016llx, %s: %ld waited for a blocked duration, %ld axes "
      "started outside the limits;\n"
      "%ld also by the slow solver, of them %ld that waited, %ld with starts outside: %ld equal "
      "within 1e-9, none longer (largest %.1e); "
      "%ld the slow solver does not know\n",
      tally.problems, static_cast<unsigned long long>(hash.value), detail::batch_kernels().name,
      tally.blocked, tally.outside, tally.slow, tally.slow_blocked, tally.slow_outside,
      tally.equal_to_slow, tally.longest_against_slow, tally.unknown);
  peer.print();
  if (count < 100000) return;
  EXPECT_GE(tally.blocked, 1000);
  EXPECT_GE(tally.outside, 1000);
}

/// How long a start beyond +V takes to come back when it decelerates to `deepest`, holds, and comes
/// up so as not to head beyond -V.
double way_back(AxisState s, const AxisLimits& l, double deepest) {
  double t = 0;
  const double step = 1e-4 * std::sqrt(l.velocity / l.jerk);
  bool rising = false;
  while (s.velocity > l.velocity) {
    const double ahead = s.velocity - s.acceleration * s.acceleration / (2 * l.jerk);
    rising = rising || (s.acceleration < 0 && ahead <= -l.velocity);
    const double jerk =
        rising ? l.jerk : -std::clamp((s.acceleration + deepest) / step, 0.0, l.jerk);
    s = advanced(s, step, jerk);
    t += step;
    if (t > 1e5 * step) return INFINITY;
  }
  return t;
}

TEST(SevenAxes, starts_beyond_the_velocity_come_back_as_fast_as_any_depth_of_deceleration) {
  Cases cases(32);
  for (int k = 0; k < 200; ++k) {
    const AxisLimits l{cases.uniform(0.2, 2), cases.uniform(0.5, 6), cases.uniform(0.5, 12)};
    const AxisState start{
        0, cases.uniform(1.05, 3) * l.velocity,
        cases.uniform(-0.3, 1) * std::min(l.acceleration, std::sqrt(l.jerk * l.velocity))};
    AxisProfile p;
    ASSERT_EQ(solve_axis(start, {20, 0, 0}, l, p), AxisOutcome::ok);
    AxisState s = start;
    double t = 0;
    const double step = 1e-4 * std::sqrt(l.velocity / l.jerk);
    Trajectory whole;
    whole.axes.push_back({start, {p.segments.begin(), p.segments.begin() + p.count}});
    MotionState3 at = rest_state(VectorXd::Zero(1));
    while (s.velocity > l.velocity * (1 + 1e-9)) {
      t += step;
      whole.sample(t, at);
      s = {at.position[0], at.velocity[0], at.acceleration[0]};
    }
    const double coarse = step * (10 + 3 * l.acceleration / std::sqrt(4 * l.jerk * l.velocity));
    for (int i = 1; i <= 60; ++i)
      ASSERT_LE(t, way_back(start, l, l.acceleration * i / 60) + coarse)
          << start.velocity << ' ' << i;
  }
}

TEST(SevenAxes, nothing_in_the_cycle_allocates) {
  Cases cases(33);
  const Problem p = draw(cases), q = draw(cases);
  SynchronisedAxes axes(kAxes);
  ASSERT_TRUE(axes.solve(p.from, p.to, p.limits));
  const Trajectory whole = solve(p.from, p.to, p.limits).trajectory;
  const SegmentTable table(whole);
  MotionState3 out = whole.at(0);
  int cursor = 0;
  AxisProblem problem;
  AxisProfile profile;
  const std::uint64_t before = test::allocations();
  axes.solve(q.from, q.to, q.limits);
  for (int k = 0; k <= 100; ++k) table.evaluate(whole.duration() * k / 100, cursor, out);
  whole.sample(0.5 * whole.duration(), out);
  for (int i = 0; i < kAxes; ++i) {
    const Case c = q.axis(i);
    problem.init(c.from, c.to, c.limits);
    problem.profile(problem.earliest(2 * problem.minimum()), profile);
    three_segment(c.from, c.to, 1.0);
  }
  EXPECT_EQ(test::allocations(), before);
}

TEST(SevenAxes, the_table_gives_the_state_of_the_trajectory) {
  Cases cases(34);
  for (int axes : {1, 2, 3, 7, 8, 9, 16, 22}) {
    for (int k = 0; k < 50; ++k) {
      Trajectory whole;
      double T = INFINITY;
      for (int i = 0; i < axes; ++i) {
        const Case c = cases.next(0);
        AxisProfile p;
        ASSERT_EQ(solve_axis(c.from, c.to, c.limits, p), AxisOutcome::ok);
        whole.axes.push_back({c.from, {p.segments.begin(), p.segments.begin() + p.count}});
        T = std::min(T, p.duration());
      }
      whole = cut(whole, 0, T);
      const SegmentTable table(whole);
      MotionState3 a = whole.at(0), b = whole.at(0);
      int cursor = 0;
      for (int i = 0; i <= 40; ++i) {
        const double t = T * (i % 2 ? i : 40 - i) / 40;
        table.evaluate(t, cursor, a);
        whole.sample(t, b);
        ASSERT_LT((a.position - b.position).norm() + (a.velocity - b.velocity).norm(), 1e-9);
        ASSERT_LT((a.acceleration - b.acceleration).norm(), 1e-8);
      }
    }
  }
}

TEST(SevenAxes, bad_input_has_a_reason_and_leaves_the_others_alone) {
  Cases cases(35);
  Problem good;
  for (int i = 0; i < kAxes; ++i) good.set(i, cases.next(0));
  SynchronisedAxes axes(kAxes);
  ASSERT_TRUE(axes.solve(good.from, good.to, good.limits));
  const double T = axes.duration();
  const auto outcome = [&](auto&& spoil) {
    Problem bad = good;
    spoil(bad);
    EXPECT_FALSE(axes.solve(bad.from, bad.to, bad.limits));
    EXPECT_STRNE(reason(axes.outcome()), "");
    EXPECT_NE(solve(bad.from, bad.to, bad.limits).reason, "");
    const AxisOutcome out = axes.outcome();
    EXPECT_TRUE(axes.solve(good.from, good.to, good.limits));
    EXPECT_EQ(axes.duration(), T);
    return out;
  };
  for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308}) {
    EXPECT_EQ(outcome([x](Problem& p) { p.from.position[3] = x, p.to.position[3] = -x; }),
              AxisOutcome::not_finite);
    if (x == 1e308) continue;
    EXPECT_EQ(outcome([x](Problem& p) { p.from.velocity[0] = x; }), AxisOutcome::not_finite);
    EXPECT_EQ(outcome([x](Problem& p) { p.to.acceleration[6] = x; }), AxisOutcome::not_finite);
    EXPECT_EQ(outcome([x](Problem& p) { p.limits.jerk[2] = x; }), AxisOutcome::not_finite);
  }
  for (const double x : {0.0, -1.0, -0.0}) {
    EXPECT_EQ(outcome([x](Problem& p) { p.limits.velocity[1] = x; }), AxisOutcome::bad_limits);
    EXPECT_EQ(outcome([x](Problem& p) { p.limits.acceleration[1] = x; }), AxisOutcome::bad_limits);
    EXPECT_EQ(outcome([x](Problem& p) { p.limits.jerk[1] = x; }), AxisOutcome::bad_limits);
  }
  EXPECT_EQ(outcome([](Problem& p) { p.to.velocity[5] = 2 * p.limits.velocity[5]; }),
            AxisOutcome::end_beyond_limits);
  EXPECT_EQ(outcome([](Problem& p) { p.to.acceleration[5] = -2 * p.limits.acceleration[5]; }),
            AxisOutcome::end_beyond_limits);
  EXPECT_EQ(outcome([](Problem& p) { p.to.position.conservativeResize(6); }),
            AxisOutcome::wrong_size);
  EXPECT_EQ(outcome([](Problem& p) { p.limits.jerk.conservativeResize(8); }),
            AxisOutcome::wrong_size);

  Problem outside_start = good;
  outside_start.from.velocity[2] = 3 * good.limits.velocity[2];
  EXPECT_TRUE(axes.solve(outside_start.from, outside_start.to, outside_start.limits));
}

TEST(SevenAxes, imposed_durations_are_inside_the_limits_whenever_that_is_possible) {
  Cases cases(36);
  int inside = 0, three = 0, short_ = 0;
  for (int k = 0; k < 20000; ++k) {
    Problem p;
    for (int i = 0; i < kAxes; ++i) p.set(i, cases.next(0));
    double min_duration = 0;
    std::vector<AxisProblem> axes(kAxes);
    for (int i = 0; i < kAxes; ++i) {
      const Case c = p.axis(i);
      ASSERT_EQ(axes[i].init(c.from, c.to, c.limits), AxisOutcome::ok);
      min_duration = std::max(min_duration, axes[i].minimum());
    }
    const double wanted = min_duration * cases.uniform(0.97, 1.3);
    bool blocked = false;
    for (const AxisProblem& a : axes) blocked = blocked || a.earliest(wanted) > wanted;
    const Solution s = solve(p.from, p.to, p.limits, Sync::time, wanted);
    if (wanted < min_duration * (1 - 1e-9)) {
      ASSERT_NE(s.reason, "");
      ++short_;
      continue;
    }
    ASSERT_EQ(s.reason, "");
    ASSERT_NEAR(s.trajectory.duration(), wanted, 1e-11 * wanted);
    const MotionState3 end = final_state(s.trajectory);
    ASSERT_LT((end.position - p.to.position).lpNorm<Eigen::Infinity>(), 1e-9);
    ASSERT_LT((end.velocity - p.to.velocity).lpNorm<Eigen::Infinity>(), 1e-9);
    ASSERT_LT((end.acceleration - p.to.acceleration).lpNorm<Eigen::Infinity>(), 1e-9);
    if (blocked) {
      ++three;
      ASSERT_NEAR(1 + s.excess, limit_ratio(s.trajectory, p.limits), 1e-9);
    } else {
      ++inside;
      ASSERT_EQ(s.excess, 0);
      ASSERT_EQ(why_not_within(s.trajectory, p.limits, kTight), "");
    }
  }
  std::printf("imposed: %d inside the limits, %d by three segments, %d too short\n", inside, three,
              short_);
  EXPECT_GT(three, 100);
  EXPECT_GT(inside, 1000);
  EXPECT_GT(short_, 100);
}

}  // namespace
}  // namespace handsel::trajectory_property_test
