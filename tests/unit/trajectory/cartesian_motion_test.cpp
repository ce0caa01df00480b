// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/cartesian_motion.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/model/srs_arm.hpp"
#include "common/trajectory/limits_check.hpp"

namespace handsel::trajectory_planner::cartesian_motion_test {
namespace {

using ::testing::HasSubstr;

class CartesianWay : public ::testing::Test {
 protected:
  CartesianWay() {
    request_.start = robot_.rest_configuration();
    home_ = chain_.forward(RobotModel::part(request_.start, arm_), nullptr);
  }
  CartesianMotion run() { return plan_cartesian(robot_, arm_, world_, request_); }
  void to(const Vector3& moved, const Vector3& turned = Vector3::Zero()) {
    CartesianWaypoint node;
    node.T_root_tool = home_;
    node.T_root_tool.translation() += moved;
    if (turned.norm() > 0)
      node.T_root_tool.linear() =
          home_.linear() * Eigen::AngleAxisd(turned.norm(), turned.normalized()).toRotationMatrix();
    request_.nodes.push_back(node);
  }
  Vector end_of(const CartesianMotion& motion) const {
    const Trajectory& run = motion.executable.approximation.trajectory;
    return run.at(run.duration()).position;
  }
  Pose tool(const Vector& joints) const { return chain_.forward(joints.head(7), nullptr); }

  RobotModel robot_{
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb")};
  const Group& arm_{robot_.require_group("arm")};
  CollisionWorld world_{robot_, nullptr};
  ik::Chain chain_{robot_, arm_, robot_.rest_configuration()};
  ik::SrsArm srs_{*ik::SrsArm::recognise(chain_)};
  CartesianRequest request_;
  Pose home_;
};

TEST_F(CartesianWay, corners_are_rounded_and_the_tool_ends_where_it_should) {
  to({0, 0.1, 0});
  to({0, 0.1, 0.1}, {0, 0, 0.4});
  to({0.05, 0, 0.1});
  const CartesianMotion motion = run();
  ASSERT_TRUE(motion.solved) << motion.reason;
  EXPECT_EQ(motion.reached, 3u);
  EXPECT_LT(motion.path.duration(), motion.duration_ptp - 0.1);
  EXPECT_LT((tool(end_of(motion)).matrix() - request_.nodes.back().T_root_tool.matrix()).norm(),
            1e-6);
  // The speed stays within its limits about any axis.
  constexpr double kStep = 0.01;
  const CartesianSettings settings;
  for (double t = 0; t + kStep <= motion.path.duration(); t += kStep) {
    const Pose a = motion.path.pose(t), b = motion.path.pose(t + kStep);
    const double turn =
        Eigen::Quaterniond(a.linear()).angularDistance(Eigen::Quaterniond(b.linear()));
    EXPECT_LT((b.translation() - a.translation()).cwiseAbs().maxCoeff(),
              kStep * settings.translation.velocity * 1.1 + 1e-9);
    EXPECT_LT(turn, kStep * settings.rotation.velocity * 1.1 * std::sqrt(3.0) + 1e-9);
  }
}

TEST_F(CartesianWay, on_a_leg_the_tool_turns_about_one_axis) {
  const Vector3 axis = Vector3(1, -2, 0.5).normalized();
  to({0.05, 0.05, 0}, 0.9 * axis);
  const CartesianMotion motion = run();
  ASSERT_TRUE(motion.solved) << motion.reason;
  for (double t = 0.2; t < motion.path.duration(); t += 0.1) {
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(home_.linear().transpose() * motion.path.pose(t).linear()));
    if (turn.angle() < 1e-3) continue;
    EXPECT_GT(turn.axis().dot(axis), 1 - 1e-9);
  }
}

TEST_F(CartesianWay, turns_add_up_beyond_a_whole_turn) {
  for (int k = 1; k <= 3; ++k) to({0, 0, 0.02 * k}, {0, 0, 0.9 * k});
  const CartesianMotion motion = run();
  ASSERT_TRUE(motion.solved) << motion.reason;
  EXPECT_NEAR(motion.path.nodes().back().active.segment<3>(3).norm(), 2.7, 1e-9);
}

TEST_F(CartesianWay, half_a_turn_needs_a_node_between_and_the_way_before_it_is_kept) {
  to({0, 0.1, 0});
  to({0, 0.1, 0.05}, {0, 0, M_PI});
  const CartesianMotion motion = run();
  EXPECT_FALSE(motion.solved);
  EXPECT_EQ(motion.reached, 1u);
  EXPECT_THAT(motion.reason, HasSubstr("node 2"));
  EXPECT_THAT(motion.reason, HasSubstr("node between"));
  EXPECT_LT((tool(end_of(motion)).matrix() - request_.nodes[0].T_root_tool.matrix()).norm(), 1e-6);
}

TEST_F(CartesianWay, a_node_out_of_reach_ends_the_way_before_it) {
  to({0, 0.1, 0});
  to({3, 0, 0});
  to({0, 0, 0});
  const CartesianMotion motion = run();
  EXPECT_FALSE(motion.solved);
  EXPECT_EQ(motion.reached, 1u);
  EXPECT_THAT(motion.reason, HasSubstr("node 2 is out of reach"));
  EXPECT_LT(
      (tool(end_of(motion)).translation() - request_.nodes[0].T_root_tool.translation()).norm(),
      1e-6);
}

TEST_F(CartesianWay, through_the_shoulder_there_is_no_way) {
  // The mirror image of the tool on the other side of the arm's base.
  CartesianWaypoint node;
  node.T_root_tool = Pose(Eigen::AngleAxisd(3.0, Vector3::UnitZ())) * home_;
  request_.nodes.push_back(node);
  const CartesianMotion motion = run();
  EXPECT_FALSE(motion.solved);
  EXPECT_FALSE(motion.reason.empty());
  EXPECT_EQ(motion.reached, 0u);
}

TEST_F(CartesianWay, equal_nodes_are_one) {
  to({0, 0, 0});
  to({0, 0.1, 0});
  to({0, 0.1, 0});
  to({0, 0.1, 0.1});
  const CartesianMotion motion = run();
  ASSERT_TRUE(motion.solved) << motion.reason;
  EXPECT_EQ(motion.path.nodes().size(), 3u);
  EXPECT_EQ(motion.reached, 4u);
}

TEST_F(CartesianWay, to_where_it_is_nothing_moves) {
  to({0, 0, 0});
  const CartesianMotion motion = run();
  EXPECT_TRUE(motion.solved) << motion.reason;
  EXPECT_EQ(motion.path.duration(), 0.0);
  EXPECT_EQ(motion.samples.size(), 1u);
}

TEST_F(CartesianWay, there_and_back_over_the_same_nodes) {
  for (int k = 0; k < 3; ++k) {
    to({0, 0.1, 0}, {0.3, 0, 0});
    to({0, 0, 0});
  }
  const CartesianMotion motion = run();
  ASSERT_TRUE(motion.solved) << motion.reason;
  EXPECT_LT((tool(end_of(motion)).matrix() - home_.matrix()).norm(), 1e-6);
  for (std::size_t i = 1; i < motion.samples.size(); ++i)
    EXPECT_LT((motion.samples[i] - motion.samples[i - 1]).lpNorm<Eigen::Infinity>(), 0.01);
}

TEST_F(CartesianWay, a_thing_in_the_way_ends_it_before_and_is_named) {
  to({0, 0.15, 0});
  to({0, 0.15, 0.25});
  Scene scene;
  scene.boxes.push_back(
      {"shelf", make_pose(home_.translation() + Vector3(0, 0.15, 0.45)), {0.5, 0.2, 0.1}, false});
  world_.set_scene(scene);
  const CartesianMotion motion = run();
  EXPECT_FALSE(motion.solved);
  EXPECT_EQ(motion.reached, 1u);
  EXPECT_THAT(motion.reason, HasSubstr("on the path to node 2"));
  EXPECT_THAT(motion.reason, HasSubstr("shelf"));
}

TEST_F(CartesianWay, a_corner_that_would_collide_keeps_its_stop) {
  to({0, 0.15, 0});
  to({0, 0.15, 0.15});
  const CartesianMotion open = run();
  ASSERT_TRUE(open.solved) << open.reason;
  ASSERT_EQ(open.corners.size(), 1u);
  ASSERT_NE(open.corners[0].method, BlendMethod::stop);
  const auto postures = [&](const CartesianMotion& motion) {
    std::vector<Vector> out(motion.samples.size(), request_.start);
    for (std::size_t i = 0; i < out.size(); ++i) out[i](motion.axes) = motion.samples[i];
    return out;
  };
  // The segments alone, with a stop between.
  const CartesianRequest both = request_;
  request_.nodes = {both.nodes[0]};
  std::vector<Vector> stopping = postures(run());
  request_.start = stopping.back();
  request_.nodes = {both.nodes[1]};
  const std::vector<Vector> rest = postures(run());
  stopping.insert(stopping.end(), rest.begin(), rest.end());
  request_ = both;
  // A small obstacle that only the blend meets.
  const std::vector<Vector> rounded = postures(open);
  const Vector& middle = rounded[rounded.size() / 2];
  const Vector3 tool = robot_.link_pose(middle, robot_.tool_link()).translation();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-0.15, 0.15);
  const auto all_free = [&](const std::vector<Vector>& way) {
    return std::all_of(way.begin(), way.end(), [&](const Vector& q) { return world_.is_free(q); });
  };
  bool found = false;
  for (int k = 0; k < 40000 && !found; ++k) {
    Scene scene;
    scene.boxes.push_back(
        {"pebble",
         make_pose(tool + Vector3(anywhere(random), anywhere(random), anywhere(random))),
         {0.003, 0.003, 0.003},
         false});
    world_.set_scene(scene);
    found = !world_.is_free(middle) && all_free(stopping);
  }
  ASSERT_TRUE(found);
  const CartesianMotion tight = run();
  ASSERT_TRUE(tight.solved) << tight.reason;
  EXPECT_TRUE(all_free(postures(tight)));
  EXPECT_GT(tight.path.duration(), open.path.duration());
  if (tight.corners[0].method == BlendMethod::stop) {
    EXPECT_THAT(tight.corners[0].reason, HasSubstr("collides"));
    EXPECT_NEAR(tight.path.duration(), tight.duration_ptp, 1e-9);
  }
}

TEST_F(CartesianWay, what_is_held_stays_level_or_the_way_is_refused) {
  request_.level = HeldLevel{home_.linear().transpose() * Vector3::UnitZ(), Vector3::UnitZ(), 0.02};
  const Vector3 up_tool = home_.linear().transpose() * Vector3::UnitZ();
  to({0, 0.1, 0}, 0.5 * up_tool);
  to({0.05, 0.1, 0.05}, 1.0 * up_tool);
  const CartesianMotion level = run();
  ASSERT_TRUE(level.solved) << level.reason;
  for (const Vector& q : level.samples)
    EXPECT_LT(std::acos(std::min(1.0, (tool(q).linear() * up_tool).z())), 0.02 + 1e-6);
  to({0.05, 0.1, 0.05}, Vector3(0.3, 0, 0));
  const CartesianMotion tilted = run();
  EXPECT_FALSE(tilted.solved);
  EXPECT_EQ(tilted.reached, 2u);
  EXPECT_THAT(tilted.reason, HasSubstr("leans"));
}

TEST_F(CartesianWay, an_open_elbow_keeps_the_joints_off_their_limits) {
  to({-0.05, 0.25, 0.1});
  const CartesianMotion free = run();
  ASSERT_TRUE(free.solved) << free.reason;
  const auto margin = [&](const CartesianMotion& motion) {
    double least = 10;
    for (const Vector& q : motion.samples)
      for (int i = 0; i < 7; ++i)
        least = std::min({least, q[i] - chain_.lower()[i], chain_.upper()[i] - q[i]});
    return least;
  };
  int solved = 0;
  double best = 0;
  for (int k = 0; k < 12; ++k) {
    request_.nodes[0].elbow = 2 * M_PI * k / 12;
    const CartesianMotion fixed = run();
    if (!fixed.solved) continue;
    ++solved;
    best = std::max(best, margin(fixed));
  }
  EXPECT_GT(solved, 1);
  EXPECT_GT(margin(free), 0.5 * best);
  EXPECT_GT(margin(free), 0.05);
}

TEST_F(CartesianWay, bad_requests_are_refused_with_what_is_wrong) {
  EXPECT_THAT(run().reason, HasSubstr("no nodes"));
  to({0, 0.1, 0});
  request_.nodes[0].T_root_tool.translation().x() = NAN;
  EXPECT_THAT(run().reason, HasSubstr("node 1 has a number that is not finite"));
  request_.nodes.clear();
  to({0, 0.1, 0});
  request_.also = {arm_.axes[0]};
  EXPECT_FALSE(run().solved);
  request_.also = robot_.require_group("head").axes;
  EXPECT_THAT(run().reason, HasSubstr("further axes"));
  request_.nodes[0].also = Eigen::Vector2d(0, 9);
  EXPECT_THAT(run().reason, HasSubstr("outside its limits"));
  request_.also.clear();
  request_.nodes[0].also.resize(0);
  request_.start.resize(3);
  EXPECT_THAT(run().reason, HasSubstr("3 axes"));
}

}  // namespace
}  // namespace handsel::trajectory_planner::cartesian_motion_test
