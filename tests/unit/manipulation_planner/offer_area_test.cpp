// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/offer_area.hpp"

#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::manipulation_planner::offer_area_test {
namespace {

class OfferAreaTest : public testing::Test {
 protected:
  OfferAreaTest() {
    Scene scene;
    scene.robot_position = rest_;
    now_.on(scene);
    ActiveTrajectory active;
    active.position = rest_;
    now_.on(active);
  }
  double clearance(const Person& person, const Vector& joints) const {
    return area_.clearance(person, RobotModel::with(rest_, arm_.group(), joints));
  }

  const std::shared_ptr<const RobotModel> robot_ =
      std::make_shared<const RobotModel>(RobotModel::load(robot_description("jido")));
  const Vector rest_ = robot_->rest_configuration();
  Snapshot now_{[](const std::string&) -> const ObjectModel* { return nullptr; }};
  const ActiveArm arm_{robot_, now_};
  const settings::ManipulationPlannerSettings settings_ =
      settings::read_manipulation_planner_settings(std::filesystem::path(HANDSEL_SOURCE_DIR) /
                                                   "deploy/config/manipulation_planner.txtpb");
  const RetreatPlanner retreat_{*robot_, arm_.group(), settings_};
  const OfferArea area_{settings_, arm_, retreat_, now_};
};

TEST_F(OfferAreaTest, a_person_near_the_hand_at_rest_gets_more_space_for_an_offer) {
  constexpr double kMinGain = 0.1;  // min increase of the free space [m]
  const double x_hand = arm_.T_world_tool().translation().x();
  int occupied = 0;
  for (const double before : {0.6, 0.7, 0.8, 0.9}) {
    for (const double beside : {-0.2, 0.0, 0.2}) {
      const Person person = test::person_at({x_hand + before, beside, 0}).people.front();
      if (!area_.is_occupied(person, rest_)) continue;
      ++occupied;
      const std::vector<Vector> places = area_.clear_configurations(person);
      ASSERT_FALSE(places.empty());
      const double space = clearance(person, places.front());
      EXPECT_GE(space, std::min(0.0, area_.clearance(person, rest_) + kMinGain))
          << before << " m before the hand, " << beside << " m beside the base";
    }
  }
  EXPECT_GT(occupied, 4) << "otherwise the test shows nothing";
}

TEST_F(OfferAreaTest, beside_the_hand_at_rest_the_area_of_the_person_becomes_clear) {
  const double x_hand = arm_.T_world_tool().translation().x();
  for (const double beside : {-0.4, -0.3}) {
    const Person person = test::person_at({x_hand + 0.8, beside, 0}).people.front();
    const std::vector<Vector> places = area_.clear_configurations(person);
    ASSERT_FALSE(places.empty());
    EXPECT_GE(clearance(person, places.front()), 0.0) << beside << " m beside the base";
  }
}

TEST_F(OfferAreaTest, an_object_in_a_persons_hand_occupies_the_area_where_it_is) {
  const Vector3 p_hand = arm_.T_world_tool().translation();
  const Person person = test::person_at({p_hand.x() + 1.6, 0, 0}).people.front();
  ASSERT_FALSE(area_.is_occupied(person, rest_));
  const auto offered_at = [&](double before, Holder holder) {
    Scene scene = now_.scene();
    SceneObject object;
    object.id = "mug";
    object.holder = holder;
    object.holder_id = person.id;
    object.T_world_object.translation() = p_hand + Vector3(before, 0, 0);
    scene.objects = {object};
    now_.on(scene);
    return area_.is_occupied(person, rest_);
  };
  EXPECT_TRUE(offered_at(0.44, Holder::human));
  EXPECT_FALSE(offered_at(0.44, Holder::surface));
  EXPECT_FALSE(offered_at(0.7, Holder::human));
}

}  // namespace
}  // namespace handsel::manipulation_planner::offer_area_test
