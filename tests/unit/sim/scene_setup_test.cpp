// SPDX-License-Identifier: Apache-2.0
// Places and supports of a scenario's objects that are drawn by the seed.
#include "sim/scene/scene_setup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.hpp"
#include "sim/scene/free_place.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace handsel::sim::scene_setup_test {
namespace {

using namespace test;
using handsel::test::message_of;
using testing::HasSubstr;

/// A table turned by 0.5 rad with a mug of fixed place, and `count` mugs at free places.
config::Scenario cluttered(int count) {
  config::Scenario scenario;
  auto* table = scenario.add_boxes();
  table->set_id("table");
  auto& pose = *table->mutable_pose();
  pose.mutable_xyz()->set_x(0.8);
  pose.mutable_xyz()->set_z(0.35);
  pose.mutable_rpy()->set_z(0.5);
  table->mutable_size()->set_x(0.7);
  table->mutable_size()->set_y(0.6);
  table->mutable_size()->set_z(0.7);
  table->set_supports(true);
  for (int i = 0; i <= count; ++i) {
    auto* object = scenario.add_objects();
    object->set_id("mug" + std::to_string(i));
    object->set_model("mug");
    object->set_on("table");
    object->mutable_pose()->mutable_xyz()->set_x(0.8);
    object->set_free_place(i > 0);
    object->set_turn(i > 0 ? 3.0 : 0.0);
  }
  return scenario;
}

SceneSetup set_up_with(const config::Scenario& scenario, std::uint64_t seed) {
  return set_up(scenario, jido(), library(), 4, {}, seed);
}

TEST(FreePlaces, objects_stand_apart_on_the_surface_as_the_seed_draws) {
  double radius = 0;
  for (const Vector3& v : library()("mug")->mesh.vertices)
    radius = std::max(radius, std::hypot(v.x(), v.y()));
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const SceneSetup setup = set_up_with(cluttered(4), seed),
                     again = set_up_with(cluttered(4), seed);
    for (std::size_t i = 0; i < 5; ++i) {
      const Pose& T = setup.objects[i].T_world_object;
      ASSERT_TRUE(T.isApprox(again.objects[i].T_world_object, 0));
      EXPECT_NEAR(T.translation().z(), 0.7 + library()("mug")->height_above_support, 1e-12);
      const Vector3 p = setup.boxes[0].T_world_box.inverse() * T.translation();
      EXPECT_LE(std::abs(p.x()), 0.35 - radius - 0.05 + 1e-12);
      EXPECT_LE(std::abs(p.y()), 0.30 - radius - 0.05 + 1e-12);
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_GE((T.translation() - setup.objects[k].T_world_object.translation()).norm(),
                  2 * radius + 0.05 - 1e-12);
    }
    EXPECT_EQ(setup.objects[0].T_world_object.translation().x(), 0.8) << "a fixed place stays";
    EXPECT_FALSE(setup.objects[1].T_world_object.linear().isIdentity(1e-3)) << "it is not turned";
  }
  EXPECT_FALSE(
      set_up_with(cluttered(1), 1)
          .objects[1]
          .T_world_object.isApprox(set_up_with(cluttered(1), 2).objects[1].T_world_object, 1e-3));
}

TEST(FreePlaces, a_box_on_the_surface_takes_its_place) {
  config::Scenario scenario = cluttered(1);
  auto* box = scenario.add_boxes();
  box->set_id("block");
  *box->mutable_pose() = scenario.boxes(0).pose();
  *box->mutable_size() = scenario.boxes(0).size();
  box->mutable_size()->set_x(0.2);
  box->mutable_size()->set_z(0.9);
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const SceneSetup setup = set_up_with(scenario, seed);
    const Vector3 p =
        setup.boxes[0].T_world_box.inverse() * setup.objects[1].T_world_object.translation();
    EXPECT_GT(std::abs(p.x()), 0.1 + 0.05);
  }
}

TEST(FreePlaces, no_free_place_is_an_error_that_names_object_and_surface) {
  EXPECT_THAT(message_of<ConfigError>([] { set_up_with(cluttered(40), 1); }),
              HasSubstr("there is no free place for object mug"));
  config::Scenario nowhere = cluttered(1);
  nowhere.mutable_objects(1)->clear_on();
  EXPECT_THAT(message_of<ConfigError>([&] { set_up_with(nowhere, 1); }),
              HasSubstr("mug1 is at a free place but `on` names no box"));
  EXPECT_FALSE(free_place({.size = {0.1, 0.1}, .circles = {}, .rectangles = {}}, 0.06, 0,
                          [] { return 0.5; }));
}

TEST(Hold, the_grasp_constraint_helps_only_where_a_scenario_asks) {
  EXPECT_FALSE(SimSettings{}.constraint);
  EXPECT_FALSE(set_up_with(cluttered(0), 1).help_hold);
  config::Scenario helped = cluttered(0);
  helped.set_help_hold(true);
  EXPECT_TRUE(set_up_with(helped, 1).help_hold);
}

}  // namespace
}  // namespace handsel::sim::scene_setup_test
