// SPDX-License-Identifier: Apache-2.0
// Objects in SPARK: unobserved, in hands, reported by two sources, under exchanged names, unknown.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/collision/collision_world.hpp"
#include "common/config/resources.hpp"
#include "components/spark/directed.hpp"
#include "components/spark/scene_model.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::spark::scene_model_test {
namespace {

using ::testing::HasSubstr;

TimePoint at(double t) { return TimePoint(from_seconds(t)); }

ObservedObject mug(const std::string& id, const Vector3& where) {
  return {id, "mug", make_pose(where), 0.9, {}, {}};
}

ObservedObject unknown(const std::string& id, const Vector3& where, PrimitiveKind kind,
                       const Vector3& size) {
  return {id, "", make_pose(where), 0.9, {}, {kind, size}};
}

Person person_at(const Vector3& feet) {
  Person anna;
  anna.id = "anna";
  anna.joints = standing_body(feet, 0, 1.75);
  return anna;
}

class SceneObjects : public ::testing::Test {
 protected:
  SceneObjects() {
    settings_ = settings::read_spark_settings(std::filesystem::path(HANDSEL_SOURCE_DIR) /
                                              "deploy/config/spark.txtpb");
    mug_.mass = 0.3;
    for (int i = 0; i < 8; ++i)
      mug_.mesh.vertices.push_back(0.04 * Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    model_.emplace(
        settings_, std::make_shared<const RobotModel>(),
        [this](const std::string& name) { return name == "mug" ? &mug_ : nullptr; },
        std::vector<SceneBox>{{"table", make_pose({0.7, 0, 0.35}), {1, 1, 0.7}, true}});
  }
  void see(double t, std::vector<ObservedObject> objects, const std::string& source = "camera") {
    model_->observe({0, source, std::move(objects)}, at(t));
  }
  /// At the rate of the node.
  Scene wait(double from, double to) {
    Scene scene;
    for (double t = from; t <= to + 1e-9; t += 0.05) scene = model_->scene(at(t), people_);
    return scene;
  }
  static const SceneObject* find(const Scene& scene, const std::string& id) {
    for (const SceneObject& object : scene.objects)
      if (object.id == id) return &object;
    return nullptr;
  }

  settings::SparkSettings settings_;
  ObjectModel mug_;
  std::optional<SceneModel> model_;
  HumanState people_;
};

/// An arm in the plane before a person, whose hand bears a load.
class HeldObjects : public SceneObjects {
 protected:
  HeldObjects() {
    model_.emplace(
        settings_, std::make_shared<const RobotModel>(test::planar_arm()),
        [this](const std::string& name) { return name == "mug" ? &mug_ : nullptr; },
        std::vector<SceneBox>{});
    people_.people = {person_at({2.2, 0, 0})};
  }
  void bear(double mass) {
    RobotState robot;
    robot.position = Vector::Zero(3);
    robot.payload = mass;
    model_->update(robot);
  }
  Holder holder(double t, double before_palm) {
    see(t, {mug("mug", {before_palm, 0, 0})});
    return find(wait(t, t), "mug")->holder;
  }
};

TEST_F(HeldObjects,
       what_leans_on_the_fingertips_is_not_in_the_hand_what_was_in_it_may_be_farther_out) {
  bear(mug_.mass);
  EXPECT_NE(holder(0, 0.33), Holder::robot);
  EXPECT_EQ(holder(0.1, 0.25), Holder::robot);
  EXPECT_EQ(holder(0.2, 0.33), Holder::robot);
  bear(0);
  EXPECT_NE(holder(0.3, 0.25), Holder::robot);
}

TEST_F(HeldObjects, a_hand_that_bears_the_end_of_a_long_object_holds_it) {
  for (Vector3& vertex : mug_.mesh.vertices) vertex.x() *= 4;
  bear(mug_.mass);
  EXPECT_NE(holder(0, 0.45), Holder::robot) << "its end leans on the fingertips";
  EXPECT_EQ(holder(0.1, 0.37), Holder::robot);
}

/// A hand with fingers gives the object to a person whose hand is at the object, too.
class GivenObjects : public SceneObjects {
 protected:
  GivenObjects() : robot_(test::small_robot()) {
    model_.emplace(
        settings_, robot_,
        [this](const std::string& name) { return name == "mug" ? &mug_ : nullptr; },
        std::vector<SceneBox>{});
    std::vector<Pose> links;
    robot_->forward(Vector::Zero(robot_->dof()), links);
    p_object_ = links[static_cast<std::size_t>(robot_->tool_link())] * Vector3(0.05, 0, 0);
    people_.people = {person_at({2.0, 0, 0})};
    people_.people[0].joints[static_cast<std::size_t>(body_joint_index("r_hand"))].position =
        p_object_ + Vector3(0.05, 0, 0);
  }
  /// Returns the holder after the robot has measured `mass` [kg] with its fingers at `fingers`
  /// [rad].
  Holder holder(double t, double mass, double fingers, double lifted = 0) {
    RobotState state;
    state.position = Vector::Zero(robot_->dof());
    for (const int axis : robot_->require_group("hand").axes) state.position[axis] = fingers;
    state.payload = mass;
    model_->update(state);
    see(t, {mug("mug", p_object_ + Vector3(0, 0, lifted))});
    return find(wait(t, t), "mug")->holder;
  }
  std::shared_ptr<const RobotModel> robot_;
  Vector3 p_object_;
};

TEST_F(GivenObjects, are_in_the_hand_of_the_robot_until_that_opens_though_a_person_carries_them) {
  ASSERT_EQ(holder(0, mug_.mass, 0.5), Holder::robot);
  EXPECT_EQ(holder(0.1, 0, 0.5), Holder::robot) << "the person bears the load";
  EXPECT_EQ(holder(0.2, 0, 0.49), Holder::robot) << "and moves the fingers with the object";
  EXPECT_EQ(holder(0.3, 0, 0.3), Holder::human) << "the fingers have opened";
}

TEST_F(GivenObjects, pulled_out_of_the_closed_hand_are_in_the_hand_of_the_person) {
  ASSERT_EQ(holder(0, mug_.mass, 0.5), Holder::robot);
  EXPECT_EQ(holder(0.1, 0, 0.5, 0.05), Holder::robot);
  EXPECT_EQ(holder(0.2, 0, 0.5, 0.1), Holder::human);
}

TEST_F(SceneObjects, out_of_sight_grows_uncertain_and_seen_again_is_sure) {
  see(0, {mug("mug", {0.7, 0, 0.74})});
  EXPECT_EQ(find(wait(0, 0.4), "mug")->uncertainty, 0);
  double before = 0;
  for (int second = 1; second < 10; ++second) {
    const double now = find(wait(second, second + 0.95), "mug")->uncertainty;
    EXPECT_GT(now, before);
    before = now;
  }
  EXPECT_NEAR(before, settings_.unseen_drift * 9.45, 0.01);
  const std::uint64_t revision = wait(10, 10).revision;
  see(10.1, {mug("mug", {0.72, 0, 0.74})});
  const Scene again = wait(10.1, 10.1);
  EXPECT_EQ(find(again, "mug")->uncertainty, 0);
  EXPECT_GT(again.revision, revision) << "planners are told";
  EXPECT_LE(find(wait(11, 200), "mug")->uncertainty, settings_.unseen_most);
}

TEST_F(SceneObjects, a_hand_near_what_nobody_sees_makes_it_uncertain_fast) {
  see(0, {mug("mug", {0.7, 0, 0.74})});
  people_.people = {person_at({1.6, 0, 0})};
  for (BodyJoint& joint : people_.people[0].joints)
    if (joint.name == "r_hand") joint.position = {0.75, 0.1, 0.8};
  EXPECT_NEAR(find(wait(0, 1.5), "mug")->uncertainty, 0.3, 0.03);
}

TEST_F(SceneObjects, in_a_hand_out_of_sight_it_moves_with_the_hand_and_leaves_with_the_person) {
  people_.people = {person_at({1.2, 0.6, 0})};
  Vector3 hand = joint_of(people_.people[0], "r_hand").position;
  see(0, {mug("mug", hand + Vector3(0.05, 0, 0.03))});
  ASSERT_EQ(find(wait(0, 0.05), "mug")->holder, Holder::human);
  for (double t = 0.1; t < 2; t += 0.05) {  // she leaves, her body hides the object
    for (BodyJoint& joint : people_.people[0].joints) joint.position.y() += 0.04;
    const Scene scene = wait(t, t);
    ASSERT_EQ(find(scene, "mug")->holder, Holder::human) << t;
    if (t < 0.12) continue;
    const Vector3 there = joint_of(people_.people[0], "r_hand").position + Vector3(0.05, 0, 0.03);
    EXPECT_LT((find(scene, "mug")->T_world_object.translation() - there).norm(), 1e-9) << t;
  }
  people_.people[0].inflation = 0.5;
  EXPECT_GE(find(wait(2, 2), "mug")->uncertainty, 0.5) << "as lost as she is";
  people_.people.clear();
  EXPECT_FALSE(find(wait(2.1, 2.1), "mug"));
  see(3, {mug("mug", {0.7, 0, 0.74})});
  EXPECT_TRUE(find(wait(3, 3), "mug"));
}

TEST_F(SceneObjects, in_a_hand_that_holds_it_on_a_table_it_is_held_until_the_hand_leaves) {
  people_.people = {person_at({1.6, 0, 0})};
  const auto put_hand = [&](const Vector3& p) {
    for (BodyJoint& joint : people_.people[0].joints)
      if (joint.name == "r_hand") joint.position = p;
  };
  const auto holder = [&](double t, double z) {
    see(t, {mug("mug", {0.7, 0, z})});
    return find(wait(t, t), "mug")->holder;
  };
  put_hand({0.78, 0, 0.74});
  EXPECT_EQ(holder(0, 0.74), Holder::surface) << "a hand beside what stands holds nothing";
  put_hand({0.78, 0, 0.94});
  EXPECT_EQ(holder(0.1, 0.94), Holder::human);
  put_hand({0.78, 0, 0.74});
  EXPECT_EQ(holder(0.2, 0.74), Holder::human) << "put on the table, the hand still at it";
  put_hand({0.84, 0, 0.74});
  EXPECT_EQ(holder(0.3, 0.74), Holder::surface);
}

TEST_F(SceneObjects, a_hand_at_the_end_of_a_long_object_holds_the_object) {
  people_.people = {person_at({1.6, 0, 0})};
  const Vector3 p_object(0.7, 0, 1.2);
  const auto holder = [&](double t, const Vector3& from_object) {
    for (BodyJoint& joint : people_.people[0].joints)
      if (joint.name == "r_hand") joint.position = p_object + from_object;
    see(t, {unknown("pole", p_object, PrimitiveKind::box, {0.05, 0.05, 0.5})});
    return find(wait(t, t), "pole")->holder;
  };
  EXPECT_EQ(holder(0.0, {0.05, 0, -0.24}), Holder::human);
  EXPECT_EQ(holder(0.1, {0.20, 0, -0.24}), Holder::nobody) << "the hand has left";
  EXPECT_EQ(holder(0.2, {0.20, 0, 0.00}), Holder::nobody) << "beside the middle";
  EXPECT_EQ(holder(0.3, {0.10, 0, 0.00}), Holder::human);
}

TEST_F(SceneObjects, in_a_hand_it_is_where_it_was_seen_and_on_a_table_the_average_counts) {
  people_.people = {person_at({1.5, 0, 0})};
  Vector3 p_hand;
  for (const BodyJoint& joint : people_.people[0].joints)
    if (joint.name == "r_hand") p_hand = joint.position;
  const auto moved = [&](const Vector3& from) {
    for (double t = 0; t < 1; t += 0.05) {
      see(t, {mug("mug", from)});
      wait(t, t);
    }
    see(1, {mug("mug", from + Vector3(0.003, 0, 0))});
    return find(wait(1, 1), "mug")->T_world_object.translation().x() - from.x();
  };
  EXPECT_NEAR(moved(p_hand), 0.003, 1e-6);
  model_.emplace(
      settings_, std::make_shared<const RobotModel>(),
      [this](const std::string& name) { return name == "mug" ? &mug_ : nullptr; },
      std::vector<SceneBox>{{"table", make_pose({0.7, 0, 0.35}), {1, 1, 0.7}, true}});
  EXPECT_LT(moved({0.7, 0.3, 0.74}), 0.001);
}

TEST_F(SceneObjects, of_two_sources_one_is_believed_and_the_other_takes_over) {
  for (int i = 0; i < 60; ++i) {
    see(i / 30.0, {mug("mug", {0.70, 0, 0.74})}, "left");
    see(i / 30.0 + 0.01, {mug("mug", {0.73, 0, 0.74})}, "right");
    const Scene scene = wait(i / 30.0 + 0.02, i / 30.0 + 0.02);
    ASSERT_NEAR(find(scene, "mug")->T_world_object.translation().x(), 0.70, 1e-9)
        << "no moving to and fro";
    ASSERT_NEAR(find(scene, "mug")->uncertainty, 0.03, 1e-6) << "where they differ";
  }
  for (int i = 60; i < 90; ++i) see(i / 30.0 + 0.01, {mug("mug", {0.73, 0, 0.74})}, "right");
  const Scene scene = wait(3, 3);
  EXPECT_NEAR(find(scene, "mug")->T_world_object.translation().x(), 0.73, 1e-6);
  EXPECT_EQ(find(scene, "mug")->uncertainty, 0);
}

TEST_F(SceneObjects, how_far_apart_two_sources_agree_is_a_setting) {
  settings_.source_agreement = 0.05;
  model_.emplace(
      settings_, std::make_shared<const RobotModel>(),
      [this](const std::string& name) { return name == "mug" ? &mug_ : nullptr; },
      std::vector<SceneBox>{});
  see(0, {mug("mug", {0.70, 0, 0.74})}, "left");
  see(0.01, {mug("mug", {0.73, 0, 0.74})}, "right");
  EXPECT_EQ(find(wait(0.02, 0.02), "mug")->uncertainty, 0);
}

TEST_F(SceneObjects, exchanged_names_move_nothing) {
  const Vector3 here(0.5, 0.2, 0.74), there(0.9, -0.2, 0.74);
  for (int i = 0; i < 30; ++i) see(i / 30.0, {mug("one", here), mug("two", there)});
  const std::uint64_t revision = wait(1, 1).revision;
  for (int i = 30; i < 60; ++i) see(i / 30.0, {mug("one", there), mug("two", here)});
  const Scene scene = wait(2, 2);
  EXPECT_LT((find(scene, "one")->T_world_object.translation() - here).norm(), 1e-6);
  EXPECT_LT((find(scene, "two")->T_world_object.translation() - there).norm(), 1e-6);
  EXPECT_EQ(scene.revision, revision);
}

TEST_F(SceneObjects, after_a_jump_both_places_count_for_a_moment) {
  for (int i = 0; i < 30; ++i) see(i / 30.0, {mug("mug", {0.5, 0, 0.74})});
  see(1, {mug("mug", {0.9, 0, 0.74})});
  EXPECT_GE(find(wait(1, 1), "mug")->uncertainty, 0.4);
  see(1.6, {mug("mug", {0.9, 0, 0.74})});
  EXPECT_EQ(find(wait(1.6, 1.6), "mug")->uncertainty, 0);
}

TEST_F(SceneObjects, from_the_past_is_no_news) {
  see(1, {mug("mug", {0.5, 0, 0.74})});
  see(0.9, {mug("mug", {0.9, 0, 0.74})});
  EXPECT_NEAR(find(wait(1, 1), "mug")->T_world_object.translation().x(), 0.5, 1e-9);
}

TEST_F(SceneObjects,
       unknown_things_enter_as_primitives_and_what_has_no_shape_is_refused_and_counted) {
  see(0, {unknown("crate", {0.6, 0, 0.8}, PrimitiveKind::box, {0.2, 0.3, 0.2}),
          unknown("nothing", {0, 0, 1}, PrimitiveKind::none, Vector3::Zero()),
          unknown("flat", {0, 0, 1}, PrimitiveKind::cylinder, {0.1, 0.1, 0}),
          {"vase", "vase", make_pose({0, 0, 1}), 0.9, {}, {}},
          {"tin",
           "tin",
           make_pose({0.5, 0.3, 0.75}),
           0.9,
           {},
           {PrimitiveKind::cylinder, {0.08, 0.08, 0.1}}}});
  const Scene scene = wait(0, 0);
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(find(scene, "crate")->primitive.kind, PrimitiveKind::box);
  EXPECT_EQ(find(scene, "crate")->holder, Holder::surface) << "it stands on the table";
  EXPECT_EQ(find(scene, "tin")->primitive.kind, PrimitiveKind::cylinder);
  EXPECT_EQ(find(scene, "tin")->model, "") << "nobody has described a tin";
  EXPECT_EQ(model_->refused(), 3u);
  EXPECT_EQ(model_->trouble(at(1)),
            "object vase of source camera is of model vase, which is not described, and has no "
            "primitive with a size above 0: refused, 3 so far");
  EXPECT_EQ(model_->trouble(at(20)), "");
}

/// A straight arm along +x at the height of its base, against one unknown object.
TEST(UnknownObjects, are_obstacles_of_their_shape_and_of_where_they_may_be) {
  const RobotModel arm = test::planar_arm();
  CollisionWorld world(arm, nullptr);
  Vector q = Vector::Zero(arm.dof());
  Scene scene;
  scene.objects = {{"crate",
                    "",
                    make_pose({0.8, 0, 0}),
                    Holder::nobody,
                    "",
                    0,
                    Vector3::Zero(),
                    {},
                    {PrimitiveKind::box, {0.1, 0.1, 0.1}},
                    0}};
  const auto touches = [&](PrimitiveKind kind, const Vector3& size, const Vector3& where,
                           double uncertainty) {
    scene.objects[0].primitive = {kind, size};
    scene.objects[0].T_world_object.translation() = where;
    scene.objects[0].uncertainty = uncertainty;
    world.set_scene(scene);
    const CollisionVerdict verdict = world.check(q);
    EXPECT_EQ(verdict.id, verdict.free ? "" : "crate");
    return !verdict.free;
  };
  for (const auto kind : {PrimitiveKind::box, PrimitiveKind::cylinder, PrimitiveKind::sphere}) {
    const Vector3 size = Vector3::Constant(0.2);
    EXPECT_TRUE(touches(kind, size, {0.8, 0.1, 0}, 0));
    EXPECT_FALSE(touches(kind, size, {0.8, 0.6, 0}, 0));
    EXPECT_TRUE(touches(kind, size, {0.8, 0.6, 0}, 0.5)) << "it may be there";
    EXPECT_FALSE(touches(kind, size, {0.8, 2.5, 0}, 0.5));
  }
}

}  // namespace
}  // namespace handsel::spark::scene_model_test
