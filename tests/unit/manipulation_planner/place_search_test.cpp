// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/placing/place_search.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/config/resources.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner::place_search_test {
namespace {

class Placing : public testing::Test {
 protected:
  Placing() {
    scene_.robot_known = true;
    scene_.boxes.push_back({"table", make_pose({0.75, 0.0, 0.35}), {0.6, 1.0, 0.7}, true});
    scene_.objects.push_back({"mug", "mug", make_pose({0.7, -0.6, 0.75}), Holder::robot, "", 0});
  }
  std::vector<Pose> places(std::size_t max_places = 50) const {
    const PlacingScene in{robot_, scene_, people_, library_};
    return free_places(in, "mug", scene_.boxes.front(), scene_.objects.front().T_world_object,
                       max_places, placing_settings({}));
  }

  /// Returns the scene and the people as they are now.
  CollisionWorld world_now() const {
    CollisionWorld world(robot_, library_);
    world.set_scene(scene_);
    world.set_people(people_);
    return world;
  }
  /// Returns a configuration whose palm is above the table with the mug below it, turned by
  /// `R_world_mug`.
  Vector held_above_table(CollisionWorld& world, const Eigen::Matrix3d& R_world_mug,
                          Attachment& held) const {
    std::mt19937 random(5);
    Vector q = robot_.rest_configuration();
    for (;;) {
      for (const int axis : robot_.require_group("arm").axes) {
        const Axis& a = robot_.axes()[static_cast<std::size_t>(axis)];
        q[axis] = std::uniform_real_distribution<double>(a.lower, a.upper)(random);
      }
      const Pose T = robot_.link_pose(q, robot_.tool_link());
      Pose T_mug = make_pose(T.translation() - Vector3(0, 0, 0.2));
      T_mug.linear() = R_world_mug;
      held.T_tool_object = T.inverse() * T_mug;
      world.set_attachment(held, {"mug"});
      if ((T_mug.translation() - Vector3(0.7, 0, 0.9)).cwiseAbs().maxCoeff() < 0.1 &&
          world.is_free(q))
        return q;
    }
  }

  RobotModel robot_ = RobotModel::load(robot_description("jido"));
  ObjectModel mug_ = ObjectModel::load(object_description("mug"));
  ObjectLibrary library_ = [this](const std::string& name) {
    return name == "mug" ? &mug_ : nullptr;
  };
  Scene scene_;
  HumanState people_;
};

TEST_F(Placing, lies_on_the_surface_clear_of_its_edge_and_of_what_stands_there) {
  scene_.objects.push_back(
      {"other", "mug", make_pose({0.7, 0.1, 0.75}), Holder::surface, "table", 0});
  const std::vector<Pose> found = places();
  ASSERT_GT(found.size(), 5u);
  for (const Pose& T : found) {
    const Vector3 p = T.translation();
    EXPECT_LT(std::abs(p.x() - 0.75), 0.3 - 0.03);
    EXPECT_LT(std::abs(p.y()), 0.5 - 0.03);
    EXPECT_NEAR(p.z(), 0.7 + mug_.height_above_support, 0.01);
    EXPECT_GT((p - Vector3(0.7, 0.1, p.z())).norm(), 0.1) << "in the other mug";
    EXPECT_NEAR(T.linear().col(2).z(), 1, 1e-9) << "not upright";
  }
}

TEST_F(Placing, is_away_from_who_stands_there) {
  const double before = places(1).front().translation().y();
  Person anna;
  anna.id = "anna";
  anna.joints = standing_body({1.2, before, 0}, 3.14159, 1.75);
  people_.people.push_back(anna);
  EXPECT_GT(std::abs(places(1).front().translation().y() - before), 0.1);
}

TEST_F(Placing, finds_none_where_all_is_taken_or_out_of_reach) {
  scene_.boxes.front().T_world_box.translation().x() = 3;
  EXPECT_TRUE(places().empty());
  scene_.boxes.front().T_world_box.translation().x() = 0.75;
  scene_.boxes.front().size = {0.1, 0.1, 0.7};
  EXPECT_TRUE(places().empty());
}

TEST_F(Placing, a_posture_puts_it_there_and_what_would_touch_is_named) {
  const Group& arm = robot_.require_group("arm");
  CollisionWorld world = world_now();
  Attachment held{"mug"};
  const Vector q = held_above_table(world, Eigen::Matrix3d::Identity(), held);
  Putting putting(world, robot_, robot_.require_group("arm"), scene_.T_world_base, {places()},
                  {0.1});
  int reached = 0;
  for (const Pose& T : places()) {
    const auto posture = putting.at(T, q, q, held);
    if (!posture) continue;
    ++reached;
    const Vector at = RobotModel::with(q, arm, posture->arm_at),
                 above = RobotModel::with(q, arm, posture->arm_above);
    EXPECT_LT(((robot_.link_pose(at, robot_.tool_link()) * held.T_tool_object).translation() -
               T.translation())
                  .norm(),
              1e-3);
    EXPECT_NEAR(posture->T_world_object.linear().col(2).z(), 1, 1e-9);
    EXPECT_NEAR(
        (robot_.link_pose(above, robot_.tool_link()) * held.T_tool_object).translation().z(),
        T.translation().z() + 0.1, 1e-3);
    EXPECT_TRUE(world.check(at).free);
    EXPECT_TRUE(world.check(above).free);
  }
  EXPECT_GT(reached, 3);
  Pose inside = places(1).front();
  inside.translation().z() -= 0.2;
  Putting into(world, robot_, robot_.require_group("arm"), scene_.T_world_base, {{inside}}, {0.1});
  EXPECT_TRUE(into.anywhere(q, q, held, 1).empty());
  EXPECT_FALSE(into.objections().empty());
}

TEST_F(Placing, a_place_found_before_the_grasp_is_found_again_from_anywhere) {
  const Group& arm = robot_.require_group("arm");
  CollisionWorld world = world_now();
  Attachment held{"mug"};
  const Vector q = held_above_table(world, Eigen::Matrix3d::Identity(), held);
  Putting before(world, robot_, arm, scene_.T_world_base, {places()}, {0.1});
  const std::vector<PlacingConfiguration> found = before.anywhere(q, q, held, 8);
  ASSERT_GT(found.size(), 3U);
  std::mt19937 random(11);
  for (const PlacingConfiguration& one : found) {
    EXPECT_TRUE(world
                    .check_motion(RobotModel::with(q, arm, one.arm_above),
                                  RobotModel::with(q, arm, one.arm_at))
                    .free)
        << "the straight path down";
    for (int trial = 0; trial < 10; ++trial) {
      Vector elsewhere = q;
      for (const int axis : arm.axes) {
        const Axis& a = robot_.axes()[static_cast<std::size_t>(axis)];
        elsewhere[axis] = std::uniform_real_distribution<double>(a.lower, a.upper)(random);
      }
      Putting again(world, robot_, arm, scene_.T_world_base, {{one.T_world_object}}, {0.1});
      again.search_near(one.arm_at);
      EXPECT_EQ(again.anywhere(elsewhere, elsewhere, held, 1).size(), 1U) << again.objections();
    }
  }
}

TEST_F(Placing, with_a_margin_the_hand_may_be_lower_than_planned) {
  const Group& arm = robot_.require_group("arm");
  CollisionWorld world = world_now();
  Attachment held{"mug"};
  const Vector q = held_above_table(world, Eigen::Matrix3d::Identity(), held);
  // The palm is beside the mug, lower in every step until the hand reaches the table.
  double lowest = 1, lowest_with_margin = 1;
  constexpr double kMargin = 0.02;
  for (double up = 0; up < 0.12; up += 0.01) {
    Attachment lower = held;
    lower.T_tool_object.translate(Vector3(0, 0, up));
    for (const double margin : {0.0, kMargin}) {
      Putting putting(world, robot_, arm, scene_.T_world_base, {places(8)}, {0.1, margin});
      const auto found = putting.anywhere(q, q, lower, 1);
      if (found.empty()) continue;
      const Vector at = RobotModel::with(q, arm, found.front().arm_at);
      double& height = margin > 0 ? lowest_with_margin : lowest;
      height = std::min(height, robot_.link_pose(at, robot_.tool_link()).translation().z());
    }
  }
  std::printf("lowest %.3f, with margin %.3f m\n", lowest, lowest_with_margin);
  EXPECT_GE(lowest_with_margin, lowest + kMargin - 0.011) << "steps of 10 mm";
  EXPECT_LE(lowest_with_margin, lowest + kMargin + 0.011);
}

TEST_F(Placing, lays_what_cannot_stand_upright_on_another_side_that_is_stable) {
  CollisionWorld world = world_now();
  const Eigen::Matrix3d upside_down = Eigen::AngleAxisd(M_PI, Vector3::UnitX()).toRotationMatrix();
  Attachment held{"mug"};
  const Vector q = held_above_table(world, upside_down, held);
  const Group& arm = robot_.require_group("arm");
  Putting upright(world, robot_, arm, scene_.T_world_base, {places()}, {0.1});
  EXPECT_TRUE(upright.anywhere(q, q, held, 1).empty())
      << "the hand would be below the mug, in the table";

  Putting lying(world, robot_, arm, scene_.T_world_base,
                lying_places(places(), mug_, placing_settings({}).min_tipping), {0.1});
  const std::vector<PlacingConfiguration> found = lying.anywhere(q, q, held, 5);
  ASSERT_FALSE(found.empty()) << lying.objections();
  for (const PlacingConfiguration& posture : found) {
    const Pose& T = posture.T_world_object;
    EXPECT_LT((T.linear() * Vector3::UnitZ()).z(), 0.9) << "upright";
    double lowest = 1.0;
    for (const Vector3& p : mug_.mesh.vertices) lowest = std::min(lowest, (T * p).z());
    EXPECT_NEAR(lowest, 0.7 + kAbovePlace, 1e-3);
    const Vector3 com = T * mug_.com;
    EXPECT_LT(std::abs(com.x() - 0.75), 0.3 - 0.03);
    EXPECT_LT(std::abs(com.y()), 0.5 - 0.03);
    const Vector at = RobotModel::with(q, arm, posture.arm_at);
    EXPECT_LT(((robot_.link_pose(at, robot_.tool_link()) * held.T_tool_object).translation() -
               T.translation())
                  .norm(),
              1e-3);
    EXPECT_TRUE(world.check(at).free);
  }
}

}  // namespace
}  // namespace handsel::manipulation_planner::place_search_test
