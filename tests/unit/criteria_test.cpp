#include "deploy/handsel/criteria.hpp"

#include <gtest/gtest.h>

#include "common/base/time.hpp"
#include "common/bus/bus.hpp"
#include "common/model/human_body.hpp"

namespace handsel {
namespace {

/// A trial told by hand: the truth every 20 ms.
class CriteriaTest : public testing::Test {
 protected:
  CriteriaTest() : world_(network_.add("sim")), criteria_(network_.add("handsel"), network_), truth_out_(world_.advertise<GroundTruth>()) {
    for (const char* component : {"spark", "costmap", "collision_checker", "attention", "path_planner", "grasp_planner",
                                  "trajectory_planner", "manipulation_planner"})
      network_.add(component);
    truth_.person = standing_body(Vector3(0.85, 0, 0), M_PI, 1.75);
    truth_.separation = 2.0;
    network_.run_for(from_seconds(0.5));
  }
  void tell(int times = 1) {
    for (int i = 0; i < times; ++i) {
      truth_.sim_time += 0.02;
      truth_out_->publish(truth_);
      network_.run_for(from_seconds(0.02));
    }
  }
  void carry(const Vector3& by, int steps) {
    for (int i = 0; i < steps; ++i) {
      truth_.T_world_object.translation() += by / steps;
      tell();
    }
  }

  LocalNetwork network_{3};
  Bus& world_;
  Criteria criteria_;
  std::unique_ptr<Publisher<GroundTruth>> truth_out_;
  GroundTruth truth_;
};

TEST_F(CriteriaTest, the_way_to_the_person_and_the_strain_of_their_arm_are_told_of_what_changes_hands) {
  truth_.T_world_object.translation() = Vector3(0, 0, 1.1);
  truth_.carrier = "surface";
  tell(5);
  EXPECT_TRUE(criteria_.fields()["discomfort"].is_null());
  truth_.carrier = "robot";
  tell();
  carry(Vector3(0.0, 0.3, 0), 20);
  carry(Vector3(0.4, 0.0, 0), 20);
  truth_.carrier = "both";
  tell();
  const nlohmann::json fields = criteria_.fields();
  EXPECT_NEAR(fields["legibility"].get<double>(), 0.5 / 0.7, 1e-9);
  EXPECT_GT(fields["discomfort"].get<double>(), 0.0);
  EXPECT_LT(fields["discomfort"].get<double>(), 1.0);
}

TEST_F(CriteriaTest, an_object_out_of_reach_is_as_uncomfortable_as_can_be_and_what_the_person_brings_has_no_way_of_the_robot) {
  truth_.carrier = "human";
  truth_.T_world_object.translation() = Vector3(-1.5, 0, 1.1);
  tell(2);
  truth_.carrier = "both";
  tell();
  EXPECT_EQ(criteria_.fields()["discomfort"], 1.0);
  EXPECT_TRUE(criteria_.fields()["legibility"].is_null());
}

TEST_F(CriteriaTest, a_delay_is_when_neither_of_them_moves) {
  tell();
  tell(50);
  truth_.robot_moving = true;
  tell(25);
  EXPECT_NEAR(criteria_.fields()["functional_delay_s"].get<double>(), 1.0, 0.021);
  EXPECT_NEAR(criteria_.fields()["robot_idle_s"].get<double>(), 1.0, 0.021);
}

}  // namespace
}  // namespace handsel
