// SPDX-License-Identifier: Apache-2.0
// Complete trajectories of an arm over DDS: below 64 kB, one datagram.
#include <cmath>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "common/messages/execution.hpp"
#include "common/model/ik_chain.hpp"
#include "components/trajectory_planner/trajectory_planner.hpp"
#include "tests/support/oracles/cdr_size.hpp"
#include "tests/support/panda_problems.hpp"
#include "tests/support/standing_person.hpp"
#include "tests/support/tool_motions.hpp"

namespace handsel::trajectory_planner::trajectory_size_test {
namespace {

constexpr std::size_t kMaxDatagram = 64 * 1024;  // max size of a datagram [byte]
constexpr unsigned kSeed = 64;

/// Sizes of the reply and of the command made from it.
void measure(const char* what, const RobotModel& robot, const TrajectoryReply& reply) {
  ASSERT_TRUE(reply.solved) << what << ": " << reply.reason;
  TrajectoryCommand command;
  command.id = 1;
  command.robot = robot.name();
  command.axes = reply.axes;
  command.trajectory = reply.trajectory;
  const std::size_t size = test::cdr_size(reply), sent = test::cdr_size(command);
  std::printf("%s: %zu axes, %.1f s, %zu segments an axis: reply %.1f kB, command %.1f kB\n", what,
              reply.axes.size(), reply.trajectory.duration(),
              reply.trajectory.axes.front().segments.size(), static_cast<double>(size) / 1024,
              static_cast<double>(sent) / 1024);
  EXPECT_LT(size, kMaxDatagram) << what;
  EXPECT_LT(sent, kMaxDatagram) << what;
}

/// A motion of the tool among postures near `home` for some seconds.
TrajectoryRequest tool_motion(const RobotModel& robot, const Group& arm,
                              const std::vector<int>& also, const Vector& home, int nodes) {
  std::mt19937 random(kSeed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const ik::Chain chain(robot, arm, home);
  TrajectoryRequest request;
  request.group = arm.name;
  request.start = home;
  request.also.assign(also.begin(), also.end());
  for (int k = 0; k < nodes; ++k) {
    Vector q = RobotModel::part(home, arm);
    for (double& x : q) x += between(-0.25, 0.25);
    TipNode node;
    node.T_world_tip = chain.forward(q, nullptr);
    node.also = home(also);
    for (double& x : node.also) x += between(0, 0.05);
    request.poses.push_back(node);
  }
  return request;
}

TEST(TrajectorySize, of_jido_is_below64k_b) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  const Group& arm = robot.require_group("arm");
  CollisionWorld world(robot, nullptr);
  HumanCost cost(robot, {});
  const std::vector<int> also = test::hand_and_head(robot);
  for (const int nodes : {4, 7}) {
    const Result result =
        plan(robot, world, cost, {},
             tool_motion(robot, arm, also, robot.rest_configuration(), nodes), {});
    EXPECT_GT(result.reply.trajectory.duration(), 5);
    measure("Jido, tool", robot, result.reply);
  }
  TrajectoryRequest request;
  request.group = "arm";
  request.start = robot.rest_configuration();
  std::mt19937 random(kSeed);
  for (int k = 0; k < 30; ++k) {
    Vector q = RobotModel::part(request.start, arm);
    if (k > 0)
      for (double& x : q) x += std::uniform_real_distribution<double>(-0.3, 0.3)(random);
    request.nodes.push_back(q);
  }
  measure("Jido, 30 nodes of the arm", robot, plan(robot, world, cost, {}, request, {}).reply);
  const Surroundings around{test::person_at({0.9, -0.3, 0}), Pose::Identity()};
  cost.set_people(around.people);
  const Result beside = plan(robot, world, cost, around, request, {});
  EXPECT_LT(beside.speed_factor, 0.9);
  measure("Jido, the same beside a person", robot, beside.reply);
}

TEST(TrajectorySize, of_the_iiwa_is_below64k_b) {
  const auto file = test::reference_data("robots/kuka_iiwa14/model.urdf");
  if (!file) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const RobotModel robot = RobotModel::load_urdf(*file);
  Group arm = robot.require_group("all");
  arm.tip = robot.link_index("lbr_iiwa_link_7");
  CollisionWorld world(robot, nullptr);
  const Vector home = test::iiwa_home();
  const TrajectoryRequest asked = tool_motion(robot, arm, {}, home, 6);
  CartesianRequest request;
  request.start = home;
  for (const TipNode& node : asked.poses)
    request.nodes.push_back({node.T_world_tip, {}, node.also});
  const CartesianMotion motion = plan_cartesian(robot, arm, world, request);
  TrajectoryReply reply;
  reply.solved = motion.solved;
  reply.reason = motion.reason;
  reply.axes.assign(motion.axes.begin(), motion.axes.end());
  reply.trajectory = motion.executable.approximation.trajectory;
  EXPECT_GT(reply.trajectory.duration(), 5);
  measure("iiwa, tool", robot, reply);
}

}  // namespace
}  // namespace handsel::trajectory_planner::trajectory_size_test
