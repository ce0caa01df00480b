// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/eval/criteria.hpp"

#include <gtest/gtest.h>

#include "common/base/time.hpp"
#include "common/bus/bus.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::criteria_test {
namespace {

/// A hand-written trial with ground truth every 20 ms.
class CriteriaTest : public testing::Test {
 protected:
  CriteriaTest()
      : world_(network_.add("sim")),
        criteria_(network_.add("handsel"), network_),
        ground_truth_out_(world_.advertise<GroundTruth>()) {
    for (const char* component :
         {"spark", "costmap", "collision_checker", "attention", "path_planner", "grasp_planner",
          "trajectory_planner", "manipulation_planner"})
      network_.add(component);
    ground_truth_.person = standing_body(Vector3(0.85, 0, 0), M_PI, 1.75);
    ground_truth_.separation = 2.0;
    network_.run_for(from_seconds(0.5));
  }
  void tell(int times = 1) {
    for (int i = 0; i < times; ++i) {
      ground_truth_.sim_time += 0.02;
      ground_truth_out_->publish(ground_truth_);
      network_.run_for(from_seconds(0.02));
    }
  }
  void carry(const Vector3& by, int steps) {
    for (int i = 0; i < steps; ++i) {
      ground_truth_.T_world_object.translation() += by / steps;
      tell();
    }
  }

  /// A person approaches at 1 m/s, nearer than 0.40 m after `first_near` steps; the arm moves from
  /// step `start`, slower from step `slower`.
  std::vector<double> reactions(int first_near, int start, int slower, double before, double after,
                                std::uint32_t causes) {
    ground_truth_.person = standing_body(Vector3(4, 0, 0), M_PI, 1.75);
    ground_truth_.separation = 0.39 + 0.02 * first_near;
    for (int i = 0; i < first_near + 60; ++i) {
      ground_truth_.robot_moving = i >= start;
      ActiveTrajectory active;
      active.robot = "jido";
      active.trajectory = i >= start ? 1 : 0;
      active.speed_factor = i >= slower ? after : before;
      active_out_->publish(active);
      ExecutionStatus status;
      status.robot = "jido";
      status.causes = i >= start ? causes : 0;
      status_out_->publish(status);
      ground_truth_.separation -= 0.02;
      for (BodyJoint& joint : ground_truth_.person) joint.position.x() -= 0.02;
      tell();
    }
    return criteria_.fields()["reactions_s"];
  }

  LocalNetwork network_{3};
  Bus& world_;
  Criteria criteria_;
  std::unique_ptr<Publisher<GroundTruth>> ground_truth_out_;
  std::unique_ptr<Publisher<ActiveTrajectory>> active_out_{world_.advertise<ActiveTrajectory>()};
  std::unique_ptr<Publisher<ExecutionStatus>> status_out_{world_.advertise<ExecutionStatus>()};
  GroundTruth ground_truth_;
};

TEST_F(CriteriaTest,
       the_way_to_the_person_and_the_strain_of_their_arm_are_told_of_what_changes_hands) {
  ground_truth_.T_world_object.translation() = Vector3(0, 0, 1.1);
  ground_truth_.carrier = "surface";
  tell(5);
  EXPECT_TRUE(criteria_.fields()["discomfort"].is_null());
  ground_truth_.carrier = "robot";
  tell();
  carry(Vector3(0.0, 0.3, 0), 20);
  carry(Vector3(0.4, 0.0, 0), 20);
  ground_truth_.carrier = "both";
  tell();
  const nlohmann::json fields = criteria_.fields();
  EXPECT_NEAR(fields["legibility"].get<double>(), 0.5 / 0.7, 1e-9);
  EXPECT_GT(fields["discomfort"].get<double>(), 0.0);
  EXPECT_LT(fields["discomfort"].get<double>(), 1.0);
}

TEST_F(CriteriaTest,
       out_of_reach_is_as_uncomfortable_as_can_be_and_what_a_person_brings_has_no_path) {
  ground_truth_.carrier = "human";
  ground_truth_.T_world_object.translation() = Vector3(-1.5, 0, 1.1);
  tell(2);
  ground_truth_.carrier = "both";
  tell();
  EXPECT_EQ(criteria_.fields()["discomfort"], 1.0);
  EXPECT_TRUE(criteria_.fields()["legibility"].is_null());
}

TEST_F(CriteriaTest, an_approach_from_behind_is_unseen_within_two_metres) {
  constexpr double kBehind = 1.6, kBefore = 0.1;  // x of the robot; the person at 0.85 faces -x
  const auto approach = [&](double x, double separation, double by) {
    const double before = criteria_.fields()["unseen_approach_s"];
    ExecutionStatus status;
    status.robot = "jido";
    status.nearest_on_robot = {x, 0.0, 1.0};
    status_out_->publish(status);
    ground_truth_.robot_moving = true;
    ground_truth_.separation = separation;
    tell();
    for (int i = 0; i < 50; ++i) {
      ground_truth_.separation += by;
      tell();
    }
    return criteria_.fields()["unseen_approach_s"].get<double>() - before;
  };
  EXPECT_NEAR(approach(kBehind, 1.9, -0.01), 1.0, 0.03);
  EXPECT_NEAR(approach(kBefore, 1.9, -0.01), 0.0, 1e-9);
  EXPECT_NEAR(approach(kBehind, 1.4, 0.01), 0.0, 1e-9) << "it leaves";
  EXPECT_NEAR(approach(kBehind, 3.0, -0.01), 0.0, 1e-9) << "it is far away";
}

TEST_F(CriteriaTest, a_delay_is_when_neither_of_them_moves) {
  tell();
  tell(50);
  ground_truth_.robot_moving = true;
  tell(25);
  EXPECT_NEAR(criteria_.fields()["functional_delay_s"].get<double>(), 1.0, 0.021);
  EXPECT_NEAR(criteria_.fields()["robot_idle_s"].get<double>(), 1.0, 0.021);
}

constexpr std::uint32_t kSlowed = 1U << static_cast<unsigned>(Cause::attention_slow);

TEST_F(CriteriaTest, who_is_slowed_for_some_time_after_somebody_came_near_reacts_late) {
  const std::vector<double> found = reactions(50, 0, 65, 1.0, 0.5, 0);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0], 0.3, 0.041);
  EXPECT_EQ(criteria_.fields()["late_reactions"], 1);
}

TEST_F(CriteriaTest, who_was_slowed_just_before_reacts_at_once) {
  EXPECT_EQ(reactions(50, 0, 40, 1.0, 0.5, kSlowed), std::vector<double>{0});
}

TEST_F(CriteriaTest, a_motion_that_begins_slowed_for_people_has_reacted) {
  EXPECT_EQ(reactions(50, 47, 1000, 0.5, 0.5, kSlowed), std::vector<double>{0});
}

TEST_F(CriteriaTest, a_motion_that_is_slow_by_itself_has_not) {
  reactions(50, 47, 1000, 0.5, 0.5, 0);
  EXPECT_EQ(criteria_.fields()["late_reactions"], 1);
}

}  // namespace
}  // namespace handsel::criteria_test
