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

TEST(Smooth, CornersKeepTheirLimitsAndNeverCostTime) {
  const std::uint64_t seed = 41;
  std::mt19937_64 random(seed);
  const auto draw = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  std::map<std::string, int> count;
  std::map<std::string, double> saved;
  double total = 0, stops = 0;
  const int corners = 1000;
  for (int k = 0; k < corners; ++k) {
    const int n = 7;
    KinematicLimits l{VectorXd(n), VectorXd(n), VectorXd(n)};
    for (int i = 0; i < n; ++i) l.velocity[i] = draw(0.3, 2), l.acceleration[i] = draw(0.6, 4), l.jerk[i] = draw(2, 16);
    std::vector<VectorXd> nodes(3, VectorXd(n));
    for (VectorXd& q : nodes) {
      for (double& x : q) x = draw(-2, 2);
    }
    const SmoothResult r = smooth(nodes, l);
    ASSERT_TRUE(r.ok()) << r.reason;
    ASSERT_EQ(why_not_within(r.trajectory, l, 0.1 + 1e-9), "") << "seed " << seed << " case " << k;
    ASSERT_LE(r.trajectory.duration(), r.duration_ptp + 1e-9);
    ASSERT_NEAR(r.trajectory.duration(), r.duration_ptp - r.corners[0].saved, 1e-9);
    ASSERT_LE(limit_share(r.trajectory, l), 1 + r.corners[0].excess + 1e-9);
    const MotionState3 end = final_state(r.trajectory);
    ASSERT_LT((end.position - nodes[2]).lpNorm<Eigen::Infinity>(), 1e-9);
    ASSERT_LT(end.velocity.norm() + end.acceleration.norm(), 1e-9);
    ++count[name(r.corners[0].method)];
    saved[name(r.corners[0].method)] += r.corners[0].saved;
    total += r.corners[0].saved;
    stops += r.duration_ptp;
  }
  for (const auto& [method, times] : count) {
    printf("%-14s %5.1f %% of corners, mean saving %.3f s\n", method.c_str(), 100.0 * times / corners, saved[method] / times);
  }
  printf("time saved: %.1f %%\n", 100 * total / stops);
  EXPECT_GT(total, 0);
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
