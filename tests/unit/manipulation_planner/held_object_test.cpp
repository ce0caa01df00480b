// SPDX-License-Identifier: Apache-2.0
// The object in the hand, with the real robot and mug.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "common/collision/collision_world.hpp"

namespace handsel::held_object_test {
namespace {

namespace fs = std::filesystem;
const fs::path kDeploy = fs::path(HANDSEL_SOURCE_DIR) / "deploy";

class Held : public ::testing::Test {
 protected:
  Held() {
    setenv("HANDSEL_HOME", kDeploy.c_str(), 1);
    held_.object = "cup";
    held_.T_tool_object = make_pose({0.08, 0.0, 0.23});
    scene_.objects.push_back({"cup", "mug", make_pose({3, 3, 1}), Holder::robot, "", 0});
    place_ = robot_.link_pose(q_, robot_.tool_link()) * held_.T_tool_object.translation();
  }
  /// A small table whose top is `depth` above the lowest point of the mug.
  void put_table(double depth, bool supports) {
    const Pose T_world_tool = robot_.link_pose(q_, robot_.tool_link());
    const Pose T_world_object =
        make_pose(T_world_tool.translation() + Vector3(0.15, 0, -0.3));  // upright, below the hand
    held_.T_tool_object = T_world_tool.inverse() * T_world_object;
    place_ = T_world_object.translation();
    lowest_ = 1e9;
    for (const Vector3& p : mug_.mesh.vertices)
      lowest_ = std::min(lowest_, (T_world_object * p).z());
    scene_.boxes = {{"table",
                     make_pose({place_.x(), place_.y(), lowest_ + depth - 0.01}),
                     {0.3, 0.3, 0.02},
                     supports}};
    world_.set_scene(scene_);
    world_.set_attachment(held_, {});
  }

  RobotModel robot_{RobotModel::load(kDeploy / "robots/jido/jido.txtpb")};
  ObjectModel mug_{ObjectModel::load(kDeploy / "objects/mug/mug.txtpb")};
  CollisionWorld world_{
      robot_, [this](const std::string& name) { return name == "mug" ? &mug_ : nullptr; }};
  Vector q_ = robot_.rest_configuration();
  Scene scene_;
  Attachment held_;
  Vector3 place_;
  double lowest_{};
};

TEST_F(Held, the_hand_may_touch_what_it_holds) {
  scene_.boxes.clear();
  world_.set_scene(scene_);
  world_.set_attachment(held_, {});
  const CollisionVerdict verdict = world_.check(q_);
  EXPECT_TRUE(verdict.free) << verdict.first << " " << verdict.second;
}

TEST_F(Held, the_same_object_not_held_and_not_allowed_is_an_obstacle) {
  scene_.objects[0].holder = Holder::surface;
  scene_.objects[0].T_world_object =
      robot_.link_pose(q_, robot_.tool_link()) * make_pose({0.02, 0.0, 0.08});
  world_.set_scene(scene_);
  const CollisionVerdict verdict = world_.check(q_);
  EXPECT_FALSE(verdict.free);
  EXPECT_EQ(verdict.second, "object cup");
  world_.set_attachment({}, {"cup"});
  EXPECT_TRUE(world_.check(q_).free);
}

TEST_F(Held, it_may_stand_a_little_inside_what_supports_it_but_not_deep_and_not_in_a_wall) {
  put_table(0.003, true);
  EXPECT_TRUE(world_.check(q_).free);
  put_table(0.003, false);
  EXPECT_FALSE(world_.check(q_).free);
  EXPECT_EQ(world_.check(q_).first, "object cup");
  EXPECT_EQ(world_.check(q_).second, "box table");
  put_table(0.008, true);
  EXPECT_FALSE(world_.check(q_).free);
}

TEST_F(Held, it_counts_for_the_distance_to_people) {
  HumanState people;
  Person person;
  person.id = "anna";
  person.joints = standing_body({place_.x() + 1.0, place_.y(), 0}, M_PI, 1.75);
  people.people.push_back(person);
  world_.set_people(people);
  world_.set_scene(scene_);
  const double without = world_.distance_to_people(q_);
  world_.set_attachment(held_, {});
  EXPECT_LE(world_.distance_to_people(q_), without);
}

}  // namespace
}  // namespace handsel::held_object_test
