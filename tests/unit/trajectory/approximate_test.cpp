// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/path/approximate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

#include "common/trajectory/limits_check.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::approximate_test {
namespace {

struct Samples {
  std::vector<double> times;
  std::vector<MotionState3> states;
};

Samples sine(double seconds, double period) {
  Samples out;
  for (int k = 0; k * period <= seconds; ++k) {
    const double t = k * period;
    MotionState3 s{Eigen::VectorXd(2), Eigen::VectorXd(2), Eigen::VectorXd(2)};
    for (int i = 0; i < 2; ++i) {
      const double w = 1 + i;
      s.position[i] = std::sin(w * t), s.velocity[i] = w * std::cos(w * t),
      s.acceleration[i] = -w * w * std::sin(w * t);
    }
    out.times.push_back(t);
    out.states.push_back(s);
  }
  return out;
}

TEST(Approximate, stays_within_the_tolerance_and_is_smaller) {
  const Samples s = sine(6, 0.002);
  const Approximation a = approximate(s.times, s.states, {1e-3, 1e-2});
  ASSERT_TRUE(a.ok()) << a.reason;
  EXPECT_LE(a.position_error, 1e-3);
  EXPECT_LE(a.velocity_error, 1e-2);
  EXPECT_GT(a.compression, 20);
  EXPECT_NEAR(a.trajectory.duration(), s.times.back(), 1e-9);
  for (std::size_t k = 0; k < s.times.size(); k += 7) {
    const MotionState3 at = a.trajectory.at(s.times[k]);
    ASSERT_LT((at.position - s.states[k].position).lpNorm<Eigen::Infinity>(), 1e-3 + 1e-9);
    ASSERT_LT((at.velocity - s.states[k].velocity).lpNorm<Eigen::Infinity>(), 1e-2 + 1e-9);
  }
  EXPECT_LT(approximate(s.times, s.states, {1e-5, 1e-4}).compression, a.compression);
}

TEST(Approximate, refuses_bad_samples) {
  Samples s = sine(1, 0.1);
  EXPECT_NE(approximate({}, {}, {}).reason, "");
  EXPECT_NE(approximate(s.times, s.states, {0, 1}).reason, "");
  s.times[3] = s.times[2];
  EXPECT_NE(approximate(s.times, s.states, {}).reason, "");
  s = sine(1, 0.1);
  s.states[1].velocity[0] = std::nan("");
  EXPECT_NE(approximate(s.times, s.states, {}).reason, "");
}

/// Sums of sines of random size and pace on several axes, exact derivatives.
Samples random_motion(std::mt19937_64& random, int axes, double seconds, double period) {
  const auto draw = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  Eigen::MatrixXd size(axes, 3), pace(axes, 3), phase(axes, 3);
  for (int i = 0; i < axes; ++i) {
    for (int k = 0; k < 3; ++k)
      size(i, k) = draw(0.05, 0.5), pace(i, k) = draw(0.3, 3), phase(i, k) = draw(0, 6);
  }
  Samples out;
  for (int k = 0; k * period <= seconds; ++k) {
    const Eigen::ArrayXXd angle = pace.array() * (k * period) + phase.array();
    out.times.push_back(k * period);
    out.states.push_back({(size.array() * angle.sin()).rowwise().sum(),
                          (size.array() * pace.array() * angle.cos()).rowwise().sum(),
                          -(size.array() * pace.array().square() * angle.sin()).rowwise().sum()});
  }
  return out;
}

void expect_within(const Approximation& a, const Samples& s,
                   const ApproximationTolerance& tolerance, const std::string& what) {
  ASSERT_TRUE(a.ok()) << a.reason;
  double x = 0, v = 0;
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    const MotionState3 at = a.trajectory.at(s.times[k] - s.times[0]);
    x = std::max(x, (at.position - s.states[k].position).lpNorm<Eigen::Infinity>());
    v = std::max(v, (at.velocity - s.states[k].velocity).lpNorm<Eigen::Infinity>());
  }
  EXPECT_LE(x, tolerance.position + 1e-9) << what;
  EXPECT_LE(v, tolerance.velocity + 1e-9) << what;
  EXPECT_EQ(a.trajectory.axes[0].segments.size(), 3u * a.pieces);
}

TEST(Approximate, random_motions_of_seven_axes_keep_the_tolerance_on_every_axis) {
  const std::uint64_t seed = 61;
  std::mt19937_64 random(seed);
  double pieces = 0, compression = 0;
  for (int k = 0; k < 40; ++k) {
    const Samples s = random_motion(random, 7, 6, 0.004);
    const ApproximationTolerance tolerance{k % 2 ? 1e-3 : 1e-4, k % 2 ? 1e-2 : 2e-3};
    const Approximation a = approximate(s.times, s.states, tolerance);
    expect_within(a, s, tolerance, "seed " + std::to_string(seed) + " case " + std::to_string(k));
    if (k % 2) pieces += a.pieces, compression += a.compression;
  }
  printf(
      "7 axes, 6 s at 250 Hz, tolerance 1e-3 rad and 1e-2 rad/s: %.1f segments an axis, %.0f times "
      "smaller\n",
      3 * pieces / 20, compression / 20);
}

TEST(Approximate, derivatives_of_exact_samples_are_right) {
  std::mt19937_64 random(62);
  const Samples s = random_motion(random, 3, 4, 0.005);
  std::vector<Eigen::VectorXd> positions;
  for (const MotionState3& m : s.states) positions.push_back(m.position);
  const Derived d = differentiate(s.times, positions);
  ASSERT_TRUE(d.ok()) << d.reason;
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    ASSERT_LT((d.samples[k].velocity - s.states[k].velocity).norm(), 1e-4);
    ASSERT_LT((d.samples[k].acceleration - s.states[k].acceleration).norm(), 0.3);
    if (k > 4 && k + 5 < s.times.size()) {
      ASSERT_LT((d.samples[k].acceleration - s.states[k].acceleration).norm(), 5e-3);
    }
  }
  EXPECT_NE(differentiate({0, 1, 2}, {positions[0], positions[1], positions[2]}).reason, "");
  positions[1][0] = std::nan("");
  EXPECT_NE(differentiate(s.times, positions).reason, "");
}

TEST(Approximate, axes_beyond_their_limits_are_slowed_down_and_only_there) {
  const std::uint64_t seed = 63;
  std::mt19937_64 random(seed);
  double stretch = 0;
  for (int k = 0; k < 30; ++k) {
    const Samples s = random_motion(random, 4, 6, 0.004);
    const KinematicLimits limits{Eigen::VectorXd::Constant(4, 0.6),
                                 Eigen::VectorXd::Constant(4, 1.5),
                                 Eigen::VectorXd::Constant(4, 8)};
    const SlowedDown slowed = slow_down(s.times, s.states, limits);
    ASSERT_TRUE(slowed.ok()) << slowed.reason;
    for (std::size_t i = 0; i < slowed.times.size(); ++i) {
      ASSERT_GT(slowed.alpha[i], 0);
      ASSERT_LE(slowed.alpha[i], 1 + 1e-12);
      ASSERT_LE(slowed.samples[i].velocity.cwiseAbs().maxCoeff(), 0.6 * (1 + 1e-9));
      ASSERT_LE(slowed.samples[i].acceleration.cwiseAbs().maxCoeff(), 1.5 * (1 + 1e-9));
      ASSERT_EQ(slowed.samples[i].position, s.states[i].position);
    }
    // The result is not slower than one time scaling for all samples.
    double whole = 1;
    for (const MotionState3& m : s.states) {
      whole = std::max({whole, m.velocity.cwiseAbs().maxCoeff() / 0.6,
                        std::sqrt(m.acceleration.cwiseAbs().maxCoeff() / 1.5)});
    }
    EXPECT_LT(slowed.times.back(), whole * s.times.back() * 1.1)
        << "seed " << seed << " case " << k;
    const Executable e = approximate_within(s.times, s.states, {2e-3, 2e-2}, limits);
    ASSERT_TRUE(e.approximation.ok()) << e.approximation.reason;
    ASSERT_EQ(why_not_within(e.approximation.trajectory, limits, 1e-9), "");
    stretch = std::max(stretch, e.stretch);
  }
  printf("lengthened afterwards by a factor of at most %.3f\n", stretch);
  const Samples easy = random_motion(random, 2, 3, 0.01);
  const Eigen::VectorXd wide = Eigen::VectorXd::Constant(2, 1e3);
  const SlowedDown same = slow_down(easy.times, easy.states, {wide, wide, wide});
  EXPECT_EQ(same.times, easy.times);
  EXPECT_NE(slow_down(easy.times, easy.states, {wide, wide, Eigen::VectorXd::Zero(2)}).reason, "");
}

TEST(Approximate, hand_of_a_real_handover) {
  const auto path =
      test::reference_data("motion/kth_handover/handover_sample/giver_RHand_pose_saved.csv");
  if (!path) GTEST_SKIP() << "HANDSEL_DATA is not set";
  std::ifstream file(*path);
  std::string line;
  std::getline(file, line);
  std::vector<double> times;
  std::vector<Eigen::VectorXd> positions;
  while (std::getline(file, line)) {
    Eigen::VectorXd p(3);
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &p[0], &p[1], &p[2]) != 3 || !p.allFinite())
      continue;
    times.push_back(static_cast<double>(times.size()) / 120);
    positions.push_back(p);
  }
  ASSERT_GT(positions.size(), 500u);
  const Derived d = differentiate(times, positions, 12);
  ASSERT_TRUE(d.ok()) << d.reason;
  const ApproximationTolerance tolerance{5e-3, 0.1};
  const Approximation a = approximate(times, d.samples, tolerance);
  expect_within(a, {times, d.samples}, tolerance, "hand");
  printf(
      "hand of the giver, %zu samples: %d segments an axis, %.1f times smaller, off by at most "
      "%.4f m and %.3f m/s\n",
      times.size(), 3 * a.pieces, a.compression, a.position_error, a.velocity_error);
  EXPECT_GT(a.compression, 3);
  const KinematicLimits limits{Eigen::VectorXd::Constant(3, 0.5), Eigen::VectorXd::Constant(3, 2),
                               Eigen::VectorXd::Constant(3, 15)};
  const Executable e = approximate_within(times, d.samples, tolerance, limits);
  ASSERT_TRUE(e.approximation.ok()) << e.approximation.reason;
  EXPECT_EQ(why_not_within(e.approximation.trajectory, limits, 1e-9), "");
  printf(
      "at 0.5 m/s, 2 m/s^2, 15 m/s^3: %.1f s instead of %.1f s, slowest alpha %.2f, lengthened by "
      "%.2f\n",
      e.approximation.trajectory.duration(), times.back(), e.slowest, e.stretch);
}

}  // namespace
}  // namespace handsel::approximate_test
