// SPDX-License-Identifier: Apache-2.0
// Closed-form inverse kinematics of the LWR and the iiwa: every branch reaches the requested pose.
// HANDSEL_POSES sets the number of random poses; the label full runs 100 000.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "common/model/srs_arm.hpp"
#include "tests/support/panda_problems.hpp"

namespace handsel::ik::srs_arm_property_test {
namespace {

constexpr unsigned kSeed = 20311;

int poses() {
  const char* text = std::getenv("HANDSEL_POSES");
  return text == nullptr ? 3000 : std::atoi(text);
}

double turn_between(double a, double b) { return std::abs(std::remainder(a - b, 2 * M_PI)); }

void every_branch_returns(const RobotModel& robot, const Group& group) {
  const Chain chain(robot, group, robot.rest_configuration());
  const auto arm = SrsArm::recognise(chain);
  ASSERT_TRUE(arm) << robot.name() << " is no arm of shoulder, elbow and wrist";
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> circle(-M_PI, M_PI), unit(0, 1);
  double worst = 0;
  std::size_t branches = 0, inside = 0;
  for (int k = 0; k < poses(); ++k) {
    Axes q(7);
    for (int i = 0; i < 7; ++i)
      q[i] = chain.lower()[i] + unit(random) * (chain.upper()[i] - chain.lower()[i]);
    const Pose T = chain.forward(q, nullptr);
    double nearest = 10;
    for (const Axes& branch : arm->branches(T, arm->elbow_angle(q))) {
      double apart = 0;
      for (int i = 0; i < 7; ++i) apart = std::max(apart, turn_between(branch[i], q[i]));
      nearest = std::min(nearest, apart);
    }
    ASSERT_LT(nearest, 1e-4) << "pose " << k
                             << ": the posture it came from is none of the branches";
    const double elbow = circle(random);
    const std::vector<Axes> found = arm->branches(T, elbow);
    ASSERT_EQ(found.size(), 8u);
    for (const Axes& branch : found) {
      worst = std::max(
          worst, (chain.forward(branch, nullptr).matrix() - T.matrix()).cwiseAbs().maxCoeff());
      ASSERT_LT(turn_between(arm->elbow_angle(branch), elbow), 1e-6) << "pose " << k;
      inside += (branch.array() >= chain.lower().array()).all() &&
                (branch.array() <= chain.upper().array()).all();
    }
    branches += found.size();
  }
  std::printf(
      "%s, seed %u: %d poses, %zu branches, %zu inside the limits, all back at the pose within "
      "%.1e\n",
      robot.name().c_str(), kSeed, poses(), branches, inside, worst);
  EXPECT_LT(worst, 1e-9);
}

TEST(SrsArm, every_branch_of_the_lwr_returns_to_the_pose) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  every_branch_returns(robot, robot.require_group("arm"));
}

TEST(SrsArm, every_branch_of_the_iiwa_returns_to_the_pose) {
  const auto file = test::reference_data("robots/kuka_iiwa14/model.urdf");
  if (!file) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const RobotModel robot = RobotModel::load_urdf(*file, {}, Meshes::skip);
  Group arm = robot.require_group("all");
  arm.tip = robot.link_index("lbr_iiwa_link_7");
  every_branch_returns(robot, arm);
}

TEST(SrsArm, there_is_no_branch_out_of_reach) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  const Chain chain(robot, robot.require_group("arm"), robot.rest_configuration());
  const auto arm = SrsArm::recognise(chain);
  ASSERT_TRUE(arm);
  EXPECT_TRUE(arm->branches(make_pose({5, 0, 0}), 0.3).empty());
  EXPECT_TRUE(arm->branches(make_pose({NAN, 0, 0}), 0.3).empty());
}

}  // namespace
}  // namespace handsel::ik::srs_arm_property_test
