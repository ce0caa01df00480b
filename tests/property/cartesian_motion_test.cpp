// SPDX-License-Identifier: Apache-2.0
// Cartesian motions of Jido's arm and of the iiwa of the reference data: pose of the tool, motion
// of the joints. HANDSEL_RUNS: number of motions per robot (12).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "common/model/srs_arm.hpp"
#include "common/trajectory/limits_check.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"
#include "tests/support/panda_problems.hpp"
#include "tests/support/processes/thread_time.hpp"
#include "tests/support/tool_motions.hpp"

namespace handsel::trajectory_planner::cartesian_motion_test {
namespace {

constexpr unsigned kSeed = 461;

struct Tally {
  int wanted{}, solved{};
  double off{}, turned{}, step{}, slowest{1}, excess{};
  std::vector<double> compression, time_ratio;  // ratio: computing time / duration
};

void follow(const RobotModel& robot, const Group& arm, const std::vector<int>& also,
            const Vector& home, int runs, Tally& tally) {
  std::mt19937 random(kSeed);
  CollisionWorld world(robot, nullptr);
  const ik::Chain chain(robot, arm, home);
  for (tally = {}; tally.solved < runs && tally.wanted < 4 * runs;) {
    const CartesianRequest request = test::tool_motion(robot, arm, also, home, world, random);
    if (request.nodes.empty()) continue;
    ++tally.wanted;
    const double begin = test::thread_time();
    const CartesianMotion motion = plan_cartesian(robot, arm, world, request);
    const double lasted = test::thread_time() - begin;
    if (!motion.solved) {
      EXPECT_FALSE(motion.reason.empty());
      EXPECT_LT(motion.reached, request.nodes.size());
      if (std::getenv("HANDSEL_RUNS") != nullptr) std::printf("  %s\n", motion.reason.c_str());
      continue;
    }
    ++tally.solved;
    tally.time_ratio.push_back(lasted / std::max(0.1, motion.path.duration()));
    tally.compression.push_back(motion.executable.approximation.compression);
    tally.slowest = std::min(tally.slowest, motion.executable.slowest);
    const Trajectory& run = motion.executable.approximation.trajectory;
    KinematicLimits limits = robot.comfort_limits();
    limits = {limits.velocity(motion.axes), limits.acceleration(motion.axes),
              limits.jerk(motion.axes)};
    EXPECT_EQ(why_not_within(run, limits, 1e-6), "");
    Vector last = motion.samples.front();
    for (std::size_t i = 0; i < motion.samples.size(); ++i) {
      const Vector at = run.at(motion.executable.times[i]).position;
      for (std::size_t axis = 0; axis < motion.axes.size(); ++axis) {
        const Axis& a = robot.axes()[static_cast<std::size_t>(motion.axes[axis])];
        EXPECT_GE(at[static_cast<Eigen::Index>(axis)], a.lower - 1e-6);
        EXPECT_LE(at[static_cast<Eigen::Index>(axis)], a.upper + 1e-6);
      }
      const Pose tool = chain.forward(at.head(7), nullptr),
                 wanted = motion.path.pose(std::min(
                     motion.path.duration(), static_cast<double>(i) * CartesianSettings().period));
      tally.off = std::max(tally.off, (tool.translation() - wanted.translation()).norm());
      tally.turned = std::max(
          tally.turned,
          Eigen::AngleAxisd(Eigen::Matrix3d(tool.linear().transpose() * wanted.linear())).angle());
      tally.step = std::max(tally.step, (motion.samples[i] - last).lpNorm<Eigen::Infinity>());
      last = motion.samples[i];
    }
    for (std::size_t k = 0; k < request.nodes.size(); ++k) {
      double min_distance = 1;
      for (std::size_t i = 0; i < motion.samples.size(); i += 5)
        min_distance = std::min(
            min_distance,
            (motion.path.pose(static_cast<double>(i) * CartesianSettings().period).translation() -
             request.nodes[k].T_root_tool.translation())
                .norm());
      EXPECT_LT(min_distance, 0.1) << "node " << k;
    }
    const Pose end = motion.path.pose(motion.path.duration());
    EXPECT_LT((end.translation() - request.nodes.back().T_root_tool.translation()).norm(), 1e-6);
    EXPECT_LT(Eigen::Quaterniond(end.linear())
                  .angularDistance(Eigen::Quaterniond(request.nodes.back().T_root_tool.linear())),
              1e-6);
  }
}

void report(const char* name, Tally& tally) {
  std::sort(tally.compression.begin(), tally.compression.end());
  std::sort(tally.time_ratio.begin(), tally.time_ratio.end());
  std::printf(
      "%s, seed %u: %d of %d motions solved; tool within %.3f mm and %.4f deg of TR, joints move "
      "at most %.4f rad a period, slowest alpha "
      "%.2f, compression %.0f (median), computed in %.2f ms a second of motion (median)\n",
      name, kSeed, tally.solved, tally.wanted, 1e3 * tally.off, tally.turned * 180 / M_PI,
      tally.step, tally.slowest,
      tally.compression.empty() ? 0.0 : tally.compression[tally.compression.size() / 2],
      tally.time_ratio.empty() ? 0.0 : 1e3 * tally.time_ratio[tally.time_ratio.size() / 2]);
}

int runs() {
  const char* asked = std::getenv("HANDSEL_RUNS");
  return asked != nullptr ? std::max(1, std::atoi(asked)) : 12;
}

TEST(CartesianMotion, of_jido_is_that_of_the_tool_with_22_active_axes) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  const Group& arm = robot.require_group("arm");
  const std::vector<int> also = test::hand_and_head(robot);
  Tally tally;
  follow(robot, arm, also, robot.rest_configuration(), runs(), tally);
  report("Jido", tally);
  EXPECT_EQ(7 + also.size(), 22u);
  EXPECT_EQ(tally.solved, runs());
  EXPECT_LT(tally.off, 1e-3);
  EXPECT_LT(tally.turned, 0.1 * M_PI / 180);
}

TEST(CartesianMotion, of_the_iiwa_is_that_of_the_tool) {
  const auto file = test::reference_data("robots/kuka_iiwa14/model.urdf");
  if (!file) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const RobotModel robot = RobotModel::load_urdf(*file);
  Group arm = robot.require_group("all");
  arm.tip = robot.link_index("lbr_iiwa_link_7");
  Tally tally;
  follow(robot, arm, {}, test::iiwa_home(), runs(), tally);
  report("iiwa", tally);
  EXPECT_EQ(tally.solved, runs());
  EXPECT_LT(tally.off, 1e-3);
  EXPECT_LT(tally.turned, 0.1 * M_PI / 180);
}

}  // namespace
}  // namespace handsel::trajectory_planner::cartesian_motion_test
