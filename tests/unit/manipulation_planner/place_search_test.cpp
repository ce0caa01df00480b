#include "components/manipulation_planner/placing/place_search.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/config/resources.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
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
    return free_places(in, "mug", scene_.boxes.front(), scene_.objects.front().T_world_object, max_places);
  }

  RobotModel robot_ = RobotModel::load(robot_description("jido"));
  ObjectModel mug_ = ObjectModel::load(object_description("mug"));
  ObjectLibrary library_ = [this](const std::string& name) { return name == "mug" ? &mug_ : nullptr; };
  Scene scene_;
  HumanState people_;
};

TEST_F(Placing, lies_on_the_surface_clear_of_its_edge_and_of_what_stands_there) {
  scene_.objects.push_back({"other", "mug", make_pose({0.7, 0.1, 0.75}), Holder::surface, "table", 0});
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
  CollisionWorld world(robot_, library_);
  world.set_scene(scene_);
  world.set_people(people_);
  // Somewhere above the table, the mug upright under the palm.
  std::mt19937 random(5);
  Vector q = robot_.rest_posture();
  Attachment held{"mug"};
  for (bool found = false; !found;) {
    for (const int axis : arm.axes) {
      const Axis& a = robot_.axes()[static_cast<std::size_t>(axis)];
      q[axis] = std::uniform_real_distribution<double>(a.lower, a.upper)(random);
    }
    const Pose T = robot_.link_pose(q, robot_.tool_link());
    const Vector3 p = T.translation() - Vector3(0, 0, 0.2);
    held.T_tool_object = T.inverse() * make_pose(p);
    world.set_attachment(held, {"mug"});
    found = (p - Vector3(0.7, 0, 0.9)).cwiseAbs().maxCoeff() < 0.1 && world.is_free(q);
  }
  Putting putting(world, robot_, robot_.require_group("arm"), scene_.T_world_base, places(), 0.1);
  int reached = 0;
  for (const Pose& T : places()) {
    const auto posture = putting.at(T, q, q, held);
    if (!posture) continue;
    ++reached;
    const Vector at = RobotModel::with(q, arm, posture->arm_at), above = RobotModel::with(q, arm, posture->arm_above);
    EXPECT_LT(((robot_.link_pose(at, robot_.tool_link()) * held.T_tool_object).translation() - T.translation()).norm(), 1e-3);
    EXPECT_NEAR(posture->T_world_object.linear().col(2).z(), 1, 1e-9);
    EXPECT_NEAR((robot_.link_pose(above, robot_.tool_link()) * held.T_tool_object).translation().z(), T.translation().z() + 0.1, 1e-3);
    EXPECT_TRUE(world.check(at).free);
    EXPECT_TRUE(world.check(above).free);
  }
  EXPECT_GT(reached, 3);
  Pose inside = places(1).front();
  inside.translation().z() -= 0.2;
  Putting into(world, robot_, robot_.require_group("arm"), scene_.T_world_base, {inside}, 0.1);
  EXPECT_TRUE(into.anywhere(q, q, held, 1).empty());
  EXPECT_FALSE(into.objections().empty());
}

}  // namespace
}  // namespace handsel::manipulation_planner
