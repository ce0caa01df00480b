// SPDX-License-Identifier: Apache-2.0
// Search of platform places with people and surfaces in reach.
#include <gtest/gtest.h>

#include "common/cost/person_frame.hpp"
#include "common/model/arm_reach.hpp"
#include "common/model/platform.hpp"
#include "components/manipulation_planner/driving/handover_place.hpp"
#include "components/manipulation_planner/driving/standing_search.hpp"
#include "tests/unit/manipulation_planner/manipulation_rig.hpp"

namespace handsel::manipulation_planner::standing_search_test {
namespace {

const std::string kMobile =
    std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido_mobile/jido_mobile.txtpb";

class StandingPlaces : public ::testing::Test {
 protected:
  static const RobotModel& robot() {
    static const RobotModel model = RobotModel::load(kMobile);
    return model;
  }
  const Group& arm() const { return robot().require_group("arm"); }
  Vector at(const Vector3& place) const {
    return with_platform_at(robot(), robot().rest_configuration(), place);
  }
  StandingSearch search(const StandingTarget& target, const ServesFrom& serves = nullptr) {
    PlatformFloor floor(robot(), {}, scene_, people_,
                        {settings_.standing_room, settings_.furniture_room});
    NavigationCost navigation(robot(), {});
    navigation.set_people(people_, scene_.T_world_base);
    const Vector q = at(start_);
    const StandingQuery query{robot(), arm(), q, scene_.T_world_base, navigation};
    return find_standing_places(query, target, floor, settings_, serves);
  }
  StandingTarget before_person() const {
    StandingTarget target;
    target.points = {comfortable_reach(people_.people[0], Side::right)};
    target.front = torso_axes(people_.people[0]).col(0).cwiseProduct(Vector3(1, 1, 0));
    return target;
  }
  static HumanState person(const Vector3& feet, double heading) {
    HumanState state;
    Person anna;
    anna.id = "anna";
    anna.joints = standing_body(feet, heading, 1.75);
    state.people.push_back(anna);
    return state;
  }
  double reach_to(const StandingPlace& place, const Vector3& p_world) const {
    const ArmReach reach = arm_reach(robot(), &arm(), arm().tip);
    const Pose T = scene_.T_world_base * robot().link_pose(at(place.place), reach.shoulder);
    return (p_world - T.translation()).norm() / reach.length;
  }

  settings::ManipulationPlannerSettings settings_ = rig::settings();
  Scene scene_;
  HumanState people_;
  Vector3 start_{-2, 0, 0};
};

TEST_F(StandingPlaces, before_a_person_within_the_arms_length_and_no_nearer_than_asked) {
  people_ = person({2, 0, 0}, M_PI);
  const StandingSearch found = search(before_person());
  ASSERT_FALSE(found.places.empty());
  CollisionWorld world(robot(), {});
  world.set_people(people_);
  for (const StandingPlace& place : found.places) {
    EXPECT_LT(place.place.x(), 1.6) << "it faces toward -x, the platform is before it";
    EXPECT_LT(reach_to(place, before_person().points[0]), 0.95) << "of the reach";
    EXPECT_GE(world.distance_to_people(at(place.place)), settings_.standing_room);
  }
}

TEST_F(StandingPlaces, not_behind_a_person_even_where_the_drive_is_shorter) {
  people_ = person({2, 0, 0}, 0.0);
  const StandingSearch found = search(before_person());
  ASSERT_FALSE(found.places.empty());
  for (const StandingPlace& place : found.places) EXPECT_GT(place.place.x(), 2.4);
}

TEST_F(StandingPlaces, a_place_that_does_not_serve_is_refused_and_the_search_ends) {
  people_ = person({2, 0, 0}, M_PI);
  const std::size_t all = search(before_person()).places.size();
  const StandingSearch left =
      search(before_person(), [](const StandingPlace& place) { return place.place.y() > 0; });
  ASSERT_FALSE(left.places.empty());
  EXPECT_GT(all, 1u);
  for (const StandingPlace& place : left.places) EXPECT_GT(place.place.y(), 0);
  std::size_t asked = 0;
  const StandingSearch none = search(before_person(), [&](const StandingPlace&) {
    ++asked;
    return false;
  });
  EXPECT_TRUE(none.places.empty());
  EXPECT_EQ(asked, settings_.standing_checks);
  ASSERT_FALSE(none.refusals.empty());
  EXPECT_EQ(none.refusals.back().what, std::to_string(asked) + " places");
}

TEST_F(StandingPlaces, something_is_handed_over_from_before_a_person_and_not_from_afar) {
  people_ = person({2, 0, 0}, M_PI);
  HandoverNeeds needs;
  needs.receiver = people_.people[0];
  needs.q = at(start_);
  needs.palm = arm().tip;
  const auto can = [&](const Vector3& place) {
    return can_hand_over_from(place, needs, robot(), arm(), scene_, settings_);
  };
  EXPECT_FALSE(can(start_));
  const StandingSearch near = search(before_person());
  EXPECT_TRUE(std::any_of(near.places.begin(), near.places.end(),
                          [&](const StandingPlace& place) { return can(place.place); }));
}

TEST_F(StandingPlaces, the_place_is_given_in_the_root_frame) {
  people_ = person({2, 0, 0}, M_PI);
  const StandingSearch without = search(before_person());
  scene_.T_world_base =
      make_pose({0.5, -0.3, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3::UnitZ())));
  const Pose T_root_start = scene_.T_world_base.inverse() * make_pose({-2, 0, 0});
  start_ = {T_root_start.translation().x(), T_root_start.translation().y(), -0.4};
  const StandingSearch with = search(before_person());
  ASSERT_FALSE(without.places.empty());
  ASSERT_FALSE(with.places.empty());
  EXPECT_LT((with.places[0].T_world_platform.matrix() - without.places[0].T_world_platform.matrix())
                .norm(),
            1e-6);
}

TEST_F(StandingPlaces, a_robot_that_stops_a_little_beside_its_place_touches_no_furniture) {
  SceneBox table;
  table.id = "table";
  table.T_world_box = make_pose({2, 0, 0.36});
  table.size = {0.7, 2.0, 0.72};
  scene_.boxes = {table};
  StandingTarget target;
  settings_.standing_places = 500;
  for (double x = 1.7; x < 2.2; x += 0.02) target.points.push_back({x, 0.0, 0.72});
  const StandingSearch found = search(target);
  ASSERT_FALSE(found.places.empty());
  CollisionWorld world(robot(), {});
  world.set_scene(scene_);
  for (const StandingPlace& place : found.places)
    for (const double x : {-0.04, 0.04})
      for (const double y : {-0.04, 0.04})
        EXPECT_TRUE(world.is_free(at(place.place + Vector3(x, y, 0))));
}

TEST_F(StandingPlaces, furniture_is_kept_free_and_what_is_out_of_reach_is_refused) {
  people_ = person({2, 0, 0}, M_PI);
  SceneBox wall;
  wall.id = "wall";
  wall.T_world_box = make_pose({1.0, 0, 1});
  wall.size = {1.0, 6, 2};
  scene_.boxes = {wall};
  const StandingSearch blocked = search(before_person());
  EXPECT_TRUE(blocked.places.empty());
  ASSERT_FALSE(blocked.refusals.empty());
  EXPECT_EQ(blocked.refusals.front().reason, "the robot would collide there");
  StandingTarget high;
  high.points = {{2, 0, 4}};
  const StandingSearch none = search(high);
  EXPECT_TRUE(none.places.empty());
  ASSERT_FALSE(none.refusals.empty());
}

}  // namespace
}  // namespace handsel::manipulation_planner::standing_search_test
