#include "common/trajectory/smooth.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"

namespace handsel {
namespace {

using Eigen::VectorXd;

VectorXd point(std::initializer_list<double> x) {
  VectorXd v(static_cast<Eigen::Index>(x.size()));
  std::copy(x.begin(), x.end(), v.begin());
  return v;
}

const KinematicLimits kFigure18{VectorXd::Constant(2, 0.1), VectorXd::Constant(2, 0.3), VectorXd::Constant(2, 0.9)};

TEST(Smooth, StraightMetreOfFigure18) {
  EXPECT_NEAR(straight_motion(point({0, 0}), point({1, 0}), kFigure18).duration(), 10.0 + 2.0 / 3.0, 1e-12);
}

/// What a set of methods makes of random corners of 7 axes: every one checked, figures as docs/trajectory.md gives them.
double smooth_corners(int corners, const SmoothSettings& settings, const char* title) {
  const std::uint64_t seed = 41;
  std::mt19937_64 random(seed);
  const auto draw = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  std::map<std::string, int> count;
  std::map<std::string, double> saved;
  double total = 0, stops = 0;
  for (int k = 0; k < corners; ++k) {
    const int n = 7;
    KinematicLimits l{VectorXd(n), VectorXd(n), VectorXd(n)};
    for (int i = 0; i < n; ++i) l.velocity[i] = draw(0.3, 2), l.acceleration[i] = draw(0.6, 4), l.jerk[i] = draw(2, 16);
    std::vector<VectorXd> nodes(3, VectorXd(n));
    for (VectorXd& q : nodes) {
      for (double& x : q) x = draw(-2, 2);
    }
    const SmoothResult r = smooth(nodes, l, settings);
    const auto fail = [&](const std::string& why) { ADD_FAILURE() << why << ", seed " << seed << " case " << k; };
    if (!r.ok()) return fail(r.reason), 0;
    const CornerReport& corner = r.corners[0];
    const MotionState3 end = final_state(r.trajectory);
    const double allowed = corner.method == CornerMethod::overlap || corner.method == CornerMethod::stop ? 1e-9 : 0.1 + 1e-9;
    if (const std::string why = why_not_within(r.trajectory, l, allowed); !why.empty()) return fail(why), 0;
    if (limit_share(r.trajectory, l) > 1 + corner.excess + 1e-9) return fail("more excess than reported"), 0;
    if (r.trajectory.duration() > r.duration_ptp + 1e-9) return fail("longer than stopping"), 0;
    if (std::abs(r.trajectory.duration() - r.duration_ptp + corner.saved) > 1e-9) return fail("the saving is not what is reported"), 0;
    if ((end.position - nodes[2]).lpNorm<Eigen::Infinity>() > 1e-9 || end.velocity.norm() + end.acceleration.norm() > 1e-9) {
      return fail("it does not end at rest at the last node"), 0;
    }
    ++count[name(corner.method)];
    saved[name(corner.method)] += corner.saved;
    total += corner.saved;
    stops += r.duration_ptp;
  }
  printf("%s, %d corners:\n", title, corners);
  for (const auto& [method, times] : count) {
    printf("  %-14s %5.1f %% of corners, mean saving %.3f s, %4.1f %% of all time\n", method.c_str(), 100.0 * times / corners,
           saved[method] / times, 100 * saved[method] / stops);
  }
  printf("  time saved: %.1f %%\n", 100 * total / stops);
  return total / stops;
}

TEST(Smooth, CornersKeepTheirLimitsAndNeverCostTime) {
  const int corners = 10000;
  const double all = smooth_corners(corners, {}, "best of all");
  SmoothSettings three, stretched, overlap;
  three.stretching = three.overlapping = false;
  stretched.three_segments = stretched.overlapping = false;
  overlap.three_segments = overlap.stretching = false;
  EXPECT_GE(all, smooth_corners(corners, three, "three segments alone"));
  EXPECT_GE(all, smooth_corners(corners, stretched, "stretched alone"));
  EXPECT_GE(all, smooth_corners(corners, overlap, "overlap alone"));
  EXPECT_GT(all, 0.1);
}

TEST(Smooth, ThePredicateIsOfferedExactlyWhatIsThenRun) {
  std::mt19937_64 random(42);
  const auto draw = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  std::map<std::string, int> seen;
  for (int k = 0; k < 300; ++k) {
    const KinematicLimits l{VectorXd::Constant(3, draw(0.3, 2)), VectorXd::Constant(3, draw(0.6, 4)), VectorXd::Constant(3, draw(2, 16))};
    std::vector<VectorXd> nodes(3, VectorXd(3));
    for (VectorXd& q : nodes) {
      for (double& x : q) x = draw(-1, 1);
    }
    Trajectory offered;
    int refusals = k % 3;
    const SmoothResult r = smooth(nodes, l, {}, [&](const Trajectory& corner) {
      offered = corner;
      return refusals-- <= 0;
    });
    const CornerReport& c = r.corners[0];
    ++seen[name(c.method)];
    if (c.method == CornerMethod::stop) continue;
    // Where the corner begins: the instant at which the whole is in the state the corner starts from.
    const double leg = straight_motion(nodes[0], nodes[1], l).duration();
    double begin = -1;
    for (double t = 0; t <= leg && begin < 0; t += leg / 4000) {
      if ((r.trajectory.at(t).position - offered.at(0).position).norm() < 2e-3) begin = t;
    }
    ASSERT_GE(begin, 0);
    for (int i = 0; i <= 40; ++i) {
      const double t = offered.duration() * i / 40;
      ASSERT_LT((r.trajectory.at(begin + t).position - offered.at(t).position).norm(), 1e-2) << name(c.method) << " case " << k;
    }
  }
  EXPECT_GT(seen["overlap"], 20);
  EXPECT_GT(seen["three_segment"] + seen["stretched"], 20);
}

TEST(Smooth, TauZeroStopsAtTheNode) {
  const std::vector<VectorXd> nodes{point({0, 0}), point({1, 0}), point({0.4, 0.8})};
  SmoothSettings settings;
  settings.tau = 0;
  const SmoothResult stop = smooth(nodes, kFigure18, settings);
  ASSERT_TRUE(stop.ok());
  EXPECT_EQ(stop.corners[0].method, CornerMethod::stop);
  EXPECT_NE(stop.corners[0].reason, "");
  EXPECT_NEAR(stop.trajectory.duration(), stop.duration_ptp, 1e-12);
  settings.tau = 1.0;
  EXPECT_LT(smooth(nodes, kFigure18, settings).trajectory.duration(), stop.duration_ptp - 0.1);
}

TEST(Smooth, AForbiddenCornerKeepsItsStopAndSaysWhy) {
  const std::vector<VectorXd> nodes{point({0, 0}), point({1, 0}), point({1, 1}), point({2, 1})};
  int asked = 0;
  const SmoothResult r = smooth(nodes, kFigure18, {}, [&asked](const Trajectory& corner) {
    ++asked;
    return corner.axes[0].start.position > 0.95;
  });
  ASSERT_TRUE(r.ok());
  ASSERT_EQ(r.corners.size(), 2u);
  EXPECT_GT(asked, 1);
  for (const CornerReport& c : r.corners) EXPECT_EQ(c.method == CornerMethod::stop, !c.reason.empty());
  const SmoothResult none = smooth(nodes, kFigure18, {}, [](const Trajectory&) { return false; });
  EXPECT_NEAR(none.trajectory.duration(), none.duration_ptp, 1e-9);
  EXPECT_NE(none.corners[1].reason, "");
}

TEST(Smooth, RefusesBadNodesAndLimits) {
  EXPECT_NE(smooth({}, kFigure18).reason, "");
  EXPECT_NE(smooth({point({0, 0}), point({1})}, kFigure18).reason, "");
  EXPECT_NE(smooth({point({0, 0}), point({1, std::nan("")})}, kFigure18).reason, "");
  EXPECT_NE(smooth({point({0}), point({1})}, kFigure18).reason, "");
  const SmoothResult same = smooth({point({0, 1}), point({0, 1})}, kFigure18);
  EXPECT_TRUE(same.ok());
  EXPECT_EQ(same.trajectory.duration(), 0);
}

}  // namespace
}  // namespace handsel
