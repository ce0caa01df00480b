#include "common/trajectory/approximate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace handsel {
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
      s.position[i] = std::sin(w * t), s.velocity[i] = w * std::cos(w * t), s.acceleration[i] = -w * w * std::sin(w * t);
    }
    out.times.push_back(t);
    out.states.push_back(s);
  }
  return out;
}

TEST(Approximate, StaysWithinTheToleranceAndIsSmaller) {
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

TEST(Approximate, RefusesBadSamples) {
  Samples s = sine(1, 0.1);
  EXPECT_NE(approximate({}, {}, {}).reason, "");
  EXPECT_NE(approximate(s.times, s.states, {0, 1}).reason, "");
  s.times[3] = s.times[2];
  EXPECT_NE(approximate(s.times, s.states, {}).reason, "");
  s = sine(1, 0.1);
  s.states[1].velocity[0] = std::nan("");
  EXPECT_NE(approximate(s.times, s.states, {}).reason, "");
}

}  // namespace
}  // namespace handsel
