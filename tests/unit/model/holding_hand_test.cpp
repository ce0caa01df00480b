// SPDX-License-Identifier: Apache-2.0
// The hand of a person on an object, averaged over noisy samples.
#include "common/model/human/holding_hand.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/model/human/holding_hand_average.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::holding_hand_test {
namespace {

constexpr double kNoise = 0.01;  // noise of each coordinate [m]

Vector3& at(Person& person, const char* joint) {
  return person.joints.at(static_cast<std::size_t>(body_joint_index(joint))).position;
}

ObjectModel box() {
  ObjectModel model;
  model.parts.push_back({Box{{0.1, 0.06, 0.2}}, Pose::Identity()});
  return model;
}

/// A person who holds a box in the right hand, and measurements of both.
class HoldingHandTest : public testing::Test {
 protected:
  HoldingHandTest() {
    SceneObject object;
    object.id = "thing";
    object.model = "box";
    object.holder = Holder::human;
    object.holder_id = "anna";
    object.T_world_object.translation() = Vector3(0.7, 0.1, 1.1);
    scene_.objects.push_back(object);
    Person anna;
    anna.id = "anna";
    anna.joints = standing_body({1.2, 0, 0}, M_PI, 1.75);
    people_.people.push_back(anna);
    hold({0.0, 0.06, -0.04}, {0.09, 0.07, -0.05});
  }

  /// Puts hand and wrist at these places of the object [m].
  void hold(const Vector3& p_hand, const Vector3& p_wrist) {
    const Pose& T = scene_.objects[0].T_world_object;
    at(people_.people[0], "r_hand") = T * p_hand;
    at(people_.people[0], "r_wrist") = T * p_wrist;
  }
  /// Adds samples with noise, while the object moves along.
  void add(int samples) {
    std::normal_distribution<double> noise(0, kNoise);
    for (int i = 0; i < samples; ++i) {
      HumanState seen = people_;
      for (const char* joint : {"r_hand", "r_wrist"})
        at(seen.people[0], joint) += Vector3(noise(random_), noise(random_), noise(random_));
      average_.add(scene_, seen);
      last_ = seen;
    }
  }
  /// Returns the distance of a joint of the averaged person from its true place [m].
  double error(const char* joint) {
    HumanState averaged = average_.averaged(scene_, last_);
    return (at(averaged.people[0], joint) - at(people_.people[0], joint)).norm();
  }

  ObjectModel box_ = box();
  HoldingHandAverage average_{[this](const std::string&) { return &box_; }, 40};
  Scene scene_;
  HumanState people_, last_;
  std::mt19937 random_{7};
};

TEST_F(HoldingHandTest, noise_is_averaged_on_an_object_that_moves) {
  add(40);
  scene_.objects[0].T_world_object.translation() += Vector3(-0.1, 0.05, 0.1);
  hold({0.0, 0.06, -0.04}, {0.09, 0.07, -0.05});
  add(40);
  EXPECT_LT(error("r_hand"), kNoise / 2);
  EXPECT_LT(error("r_wrist"), kNoise / 2);
  EXPECT_EQ(at(last_.people[0], "l_hand"),
            at(average_.averaged(scene_, last_).people[0], "l_hand"));
}

TEST_F(HoldingHandTest, a_hand_at_another_place_begins_anew) {
  add(40);
  hold({0.0, 0.06, 0.08}, {0.09, 0.07, 0.09});
  add(1);
  EXPECT_LT(error("r_hand"), 4 * kNoise);
  add(39);
  EXPECT_LT(error("r_hand"), kNoise / 2);
}

TEST_F(HoldingHandTest, a_hand_that_moves_on_the_object_by_4_cm_begins_anew) {
  add(40);
  hold({0.0, 0.06, 0.0}, {0.09, 0.07, -0.01});
  add(15);
  EXPECT_LT(error("r_hand"), kNoise);
  add(25);
  EXPECT_LT(error("r_hand"), kNoise / 2);
}

TEST_F(HoldingHandTest, an_object_in_nobodys_hand_changes_nobody) {
  add(40);
  scene_.objects[0].holder = Holder::robot;
  add(1);
  EXPECT_EQ(at(average_.averaged(scene_, last_).people[0], "r_hand"),
            at(last_.people[0], "r_hand"));
}

TEST_F(HoldingHandTest, an_observed_palm_is_averaged_on_an_object_that_turns) {
  std::normal_distribution<double> noise(0, 0.2);
  Vector3 palm = Vector3(0.2, -1, 0.1).normalized();  // of the object
  const auto add_samples = [&](int samples) {
    for (int i = 0; i < samples; ++i) {
      const Vector3 seen =
          (palm + Vector3(noise(random_), noise(random_), noise(random_))).normalized();
      people_.people[0].palms = {{"r_hand", scene_.objects[0].T_world_object.linear() * seen}};
      add(1);
    }
  };
  add(40);  // knuckles are observed later than the hand
  add_samples(40);
  scene_.objects[0].T_world_object.rotate(Eigen::AngleAxisd(0.8, Vector3::UnitZ()));
  hold({0.0, 0.06, -0.04}, {0.09, 0.07, -0.05});
  add_samples(1);
  const HumanState averaged = average_.averaged(scene_, last_);
  ASSERT_EQ(averaged.people[0].palms.size(), 1u);
  const Vector3 expected = scene_.objects[0].T_world_object.linear() * palm;
  EXPECT_LT(std::acos(averaged.people[0].palms[0].normal.dot(expected)), 0.1);
  people_.people[0].palms.clear();
  add(20);
  EXPECT_TRUE(average_.averaged(scene_, last_).people[0].palms.empty());
}

TEST_F(HoldingHandTest, the_nearer_hand_holds) {
  const Pose& T = scene_.objects[0].T_world_object;
  const auto right = holding_hand(people_.people[0], box_, T);
  ASSERT_TRUE(right.has_value());
  EXPECT_EQ(right->side, Side::right);
  EXPECT_LT((right->p_hand - Vector3(0.0, 0.06, -0.04)).norm(), 1e-9);
  at(people_.people[0], "l_hand") = T.translation();
  EXPECT_EQ(holding_hand(people_.people[0], box_, T)->side, Side::left);
  std::erase_if(people_.people[0].joints, [](const BodyJoint& j) { return j.name == "l_wrist"; });
  EXPECT_FALSE(holding_hand(people_.people[0], box_, T).has_value());
}

}  // namespace
}  // namespace handsel::holding_hand_test
