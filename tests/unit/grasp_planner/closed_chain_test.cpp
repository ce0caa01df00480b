// SPDX-License-Identifier: Apache-2.0
// Two arms joined by a held object: along random motions of the first arm, the tip of the second
// keeps its grasp, by forward kinematics.
#include "components/trajectory_planner/closed_chain.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "common/config/resources.hpp"
#include "components/grasp_planner/pair/carried_motion.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"

namespace handsel::trajectory_planner::closed_chain_test {
namespace {

constexpr double kApart = 1e-3, kTurned = 0.2 * std::numbers::pi / 180;

struct Pair {
  RobotModel robot = RobotModel::load(robot_description("duo"));
  const Group& first = robot.require_group("arm");
  const Group& second = robot.require_group("left_arm");
  std::mt19937 random{71};

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }

  /// Off the limits and off rest.
  Vector somewhere() {
    Vector q = robot.rest_configuration();
    for (const Group* arm : {&first, &second}) {
      for (const int i : arm->axes) {
        const Axis& axis = robot.axes()[static_cast<std::size_t>(i)];
        q[i] = std::clamp(q[i] + between(-0.5, 0.5), axis.lower + 0.5, axis.upper - 0.5);
      }
    }
    return q;
  }
  JoinedArm joined(const Vector& q) const {
    return {&second, robot.link_pose(q, first.tip).inverse() * robot.link_pose(q, second.tip)};
  }
  JoinError error(const Vector& q, const JoinedArm& as) const {
    return join_error(robot.link_pose(q, first.tip).inverse() * robot.link_pose(q, second.tip),
                      as.T_tip_follower);
  }
};

TEST(ClosedChain, follows_random_motions_of_the_first_arm_with_the_tips_joined) {
  Pair pair;
  int followed = 0;
  for (int run = 0; run < 100; ++run) {
    const Vector start = pair.somewhere();
    const JoinedArm joined = pair.joined(start);
    ClosedChain chain(pair.robot, joined, start);
    ASSERT_EQ(chain.objection(pair.robot.link_pose(start, pair.first.tip)), "");
    Vector towards = Vector::Zero(pair.robot.dof());
    for (const int i : pair.first.axes) towards[i] = pair.between(-0.25, 0.25);
    std::string why;
    for (int k = 0; k <= 100; ++k) {
      Vector q = start + k / 100.0 * towards;
      if (!chain.follow(pair.robot.link_pose(q, pair.first.tip), 0.1, why)) break;
      q(chain.axes()) = chain.joints();
      const JoinError off = pair.error(q, joined);
      ASSERT_LE(off.apart, 1e-6) << "run " << run;
      ASSERT_LE(off.turned, 1e-6) << "run " << run;
      for (const int i : chain.axes()) {
        const Axis& axis = pair.robot.axes()[static_cast<std::size_t>(i)];
        ASSERT_GE(q[i], axis.lower);
        ASSERT_LE(q[i], axis.upper);
      }
      followed += k == 100 ? 1 : 0;
    }
    EXPECT_TRUE(why.empty() || why.find("left_") != std::string::npos) << why;
  }
  EXPECT_GE(followed, 50);
}

TEST(ClosedChain, keeps_its_elbow_and_begins_anew) {
  Pair pair;
  const Vector start = pair.somewhere();
  ClosedChain chain(pair.robot, pair.joined(start), start);
  const ik::Chain alone(pair.robot, pair.second, start);
  const auto arm = ik::SrsArm::recognise(alone);
  ASSERT_TRUE(arm);
  const double elbow = arm->elbow_angle(RobotModel::part(start, pair.second));
  Pose T = pair.robot.link_pose(start, pair.first.tip);
  T.translation().z() += 0.02;
  std::string why;
  ASSERT_TRUE(chain.follow(T, 0.5, why)) << why;
  EXPECT_NEAR(std::remainder(arm->elbow_angle(chain.joints()) - elbow, 2 * std::numbers::pi), 0,
              1e-6);
  chain.restart();
  EXPECT_EQ(chain.joints(), RobotModel::part(start, pair.second));
}

TEST(ClosedChain, tips_that_are_not_joined_are_refused) {
  Pair pair;
  const Vector start = pair.somewhere();
  JoinedArm joined = pair.joined(start);
  joined.T_tip_follower.translation().x() += 0.01;
  const ClosedChain chain(pair.robot, joined, start);
  const std::string why = chain.objection(pair.robot.link_pose(start, pair.first.tip));
  EXPECT_NE(why.find("10.0 mm"), std::string::npos) << why;
}

TEST(ClosedChain, planned_motion_keeps_the_tips_joined_at_every_time) {
  Pair pair;
  CollisionWorld world(pair.robot, nullptr);
  int planned = 0;
  for (int run = 0; run < 40; ++run) {
    CartesianRequest request;
    request.start = pair.somewhere();
    if (!world.is_free(request.start)) continue;
    request.joined = pair.joined(request.start);
    CartesianWaypoint node;
    node.T_root_tool = pair.robot.link_pose(request.start, pair.first.tip);
    for (int i = 0; i < 3; ++i) node.T_root_tool.translation()[i] += pair.between(-0.08, 0.08);
    request.nodes = {node};
    const CartesianMotion motion = plan_cartesian(pair.robot, pair.first, world, request);
    if (!motion.solved) {
      EXPECT_FALSE(motion.reason.empty());
      continue;
    }
    ++planned;
    const Trajectory& run_by = motion.executable.approximation.trajectory;
    for (int k = 0; k <= 200; ++k) {
      const Vector now = run_by.at(run_by.duration() * k / 200).position;
      Vector q = request.start;
      for (std::size_t i = 0; i < motion.axes.size(); ++i)
        q[motion.axes[i]] = now[static_cast<Eigen::Index>(i)];
      const JoinError off = pair.error(q, *request.joined);
      ASSERT_LE(off.apart, kApart) << "run " << run;
      ASSERT_LE(off.turned, kTurned) << "run " << run;
    }
  }
  EXPECT_GE(planned, 10);
}

TEST(CarriedMotion, goes_through_every_pose_with_its_elbow_kept_and_room_to_the_limits) {
  Pair pair;
  int found = 0;
  for (int run = 0; run < 20; ++run) {
    const Vector start = pair.somewhere();
    const Pose T = pair.robot.link_pose(start, pair.first.tip);
    Pose up = T, over = T;
    up.translation().z() += 0.1;
    over.translation() += Vector3(0.1, 0.05, 0.1);
    const std::vector<Pose> way = grasp_planner::path_of_object({T, up, over}, 0.03);
    for (std::size_t k = 1; k < way.size(); ++k)
      EXPECT_LE((way[k].translation() - way[k - 1].translation()).norm(), 0.03 + 1e-9);
    const ik::Chain chain(pair.robot, pair.first, start);
    const auto arm = ik::SrsArm::recognise(chain);
    for (const auto& carried : grasp_planner::carried_motions(pair.robot, pair.first, start, way)) {
      ++found;
      ASSERT_EQ(carried.joints.size(), way.size());
      double room = 1e9;
      for (std::size_t k = 0; k < way.size(); ++k) {
        const Vector& q = carried.joints[k];
        const JoinError off = join_error(chain.forward(q, nullptr), way[k]);
        EXPECT_LE(off.apart, 1e-6);
        EXPECT_LE(off.turned, 1e-6);
        EXPECT_NEAR(std::remainder(arm->elbow_angle(q) - arm->elbow_angle(carried.joints.front()),
                                   2 * std::numbers::pi),
                    0, 1e-4);
        room = std::min({room, (q - chain.lower()).minCoeff(), (chain.upper() - q).minCoeff()});
      }
      EXPECT_NEAR(carried.room, room, 1e-12);
      EXPECT_GE(carried.room, grasp_planner::CarriedSettings{}.min_room);
    }
  }
  EXPECT_GT(found, 20);
}

}  // namespace
}  // namespace handsel::trajectory_planner::closed_chain_test
