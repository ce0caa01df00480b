// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/retreat_planner.hpp"

#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::manipulation_planner::retreat_planner_test {
namespace {

class RetreatPlannerTest : public testing::Test {
 protected:
  double distance(const Vector& q) const {
    std::vector<Pose> T_root_link;
    robot.forward(q, T_root_link);
    return separation(robot_capsules(robot), T_root_link, Pose::Identity(), people).distance;
  }
  /// Somebody `gap` [m] away from the arm at rest, in that direction from its hand [rad].
  void stand(double gap, double direction) {
    std::vector<Pose> T_root_link;
    robot.forward(rest, T_root_link);
    const Vector3 hand = T_root_link[static_cast<std::size_t>(arm.tip)].translation();
    double away = 2.0;
    do {
      away -= 0.005;
      people = test::person_at(
          {hand.x() + away * std::cos(direction), hand.y() + away * std::sin(direction), 0.0});
    } while (distance(rest) > gap);
  }

  const RobotModel robot = RobotModel::load(robot_description("jido"));
  const Group& arm = robot.require_group("arm");
  const Vector rest = robot.rest_configuration();
  const settings::ManipulationPlannerSettings settings;
  const RetreatPlanner retreat{robot, arm, settings};
  HumanState people;
};

TEST_F(RetreatPlannerTest, every_step_leads_away_from_whoever_stands_near) {
  for (double direction = -1.2; direction <= 1.2; direction += 0.3) {
    stand(0.07, direction);
    ASSERT_NEAR(distance(rest), 0.07, 0.01) << direction;
    const std::vector<Vector> steps = retreat.steps_away(rest, Pose::Identity(), people, 0.15);
    ASSERT_FALSE(steps.empty()) << direction;
    double before = distance(rest);
    for (const Vector& step : steps) {
      const double now = distance(RobotModel::with(rest, arm, step));
      EXPECT_GT(now, before) << direction;
      before = now;
    }
  }
}

TEST_F(RetreatPlannerTest, the_hands_of_the_partner_do_not_count_as_near) {
  stand(0.4, 0.0);
  Person& person = people.people[0];
  const Vector3 p_hand = robot.link_pose(rest, arm.tip).translation();
  person.joints[static_cast<std::size_t>(body_joint_index("r_hand"))].position = p_hand;
  const double near = retreat.separation(rest, Pose::Identity(), people, "somebody else");
  EXPECT_NEAR(near, distance(rest), 1e-9);
  EXPECT_LT(near, 0.05);
  EXPECT_GT(retreat.separation(rest, Pose::Identity(), people, person.id), 0.2);
}

TEST_F(RetreatPlannerTest, toward_and_past_a_person_is_not_away) {
  stand(0.07, 0.0);
  const std::vector<Vector> steps = retreat.steps_away(rest, Pose::Identity(), people, 0.05);
  ASSERT_FALSE(steps.empty());
  const Vector away = RobotModel::with(rest, arm, steps.front());
  EXPECT_TRUE(retreat.leads_away(rest, away, Pose::Identity(), people));
  EXPECT_FALSE(retreat.leads_away(rest, 2.0 * rest - away, Pose::Identity(), people));
  Vector past = rest;
  past[arm.axes[0]] += 0.3;
  EXPECT_FALSE(retreat.leads_away(rest, past, Pose::Identity(), people));
}

TEST_F(RetreatPlannerTest, with_nobody_near_every_direction_is_open_and_none_is_needed) {
  stand(0.8, 0.0);
  Vector past = rest;
  past[arm.axes[0]] += 0.3;
  EXPECT_TRUE(retreat.leads_away(rest, past, Pose::Identity(), people));
  EXPECT_TRUE(retreat.steps_away(rest, Pose::Identity(), people, 0.15).empty());
}

TEST_F(RetreatPlannerTest, the_range_within_which_people_are_near_is_a_setting) {
  stand(0.07, 0.0);
  settings::ManipulationPlannerSettings changed;
  changed.retreat_range = 0.05;
  const RetreatPlanner other{robot, arm, changed};
  EXPECT_FALSE(retreat.steps_away(rest, Pose::Identity(), people, 0.05).empty());
  EXPECT_TRUE(other.steps_away(rest, Pose::Identity(), people, 0.05).empty());
}

}  // namespace
}  // namespace handsel::manipulation_planner::retreat_planner_test
