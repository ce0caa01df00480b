// SPDX-License-Identifier: Apache-2.0
// Two hands that hold one object: the pull on both counts, and both release at the same time.
#include <gtest/gtest.h>

#include <array>

#include "common/config/resources.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/manipulator.hpp"
#include "common/trajectory/edit.hpp"
#include "components/trajectory_controller/hand/hands.hpp"

namespace handsel::trajectory_controller::both_hands_test {
namespace {

constexpr double kPeriod = 0.001;
constexpr double kPullForce = 4.0;  // of the release [N]

/// Duo at rest before a person whose hands are near; each hand bears half of a load.
class BothHandsTest : public testing::Test {
 protected:
  BothHandsTest()
      : robot_(RobotModel::load(robot_description("duo"))),
        hands_({}, robot_, kPeriod),
        people_(0.5),
        on_path_(static_cast<std::size_t>(robot_.dof()), 0) {
    state_.position = robot_.rest_configuration();
    state_.velocity = state_.effort = Vector::Zero(robot_.dof());
    state_.other_hands.resize(1);
    next_ = rest_state(state_.position);
    robot_.forward(state_.position, links_);
    hands_.reset(state_.position, nullptr);
    Person anna;
    anna.id = "anna";
    anna.joints = standing_body({1.0, 0, 0}, M_PI, 1.75);
    for (const char* name : {"l_hand", "r_hand"})
      anna.joints[static_cast<std::size_t>(body_joint_index(name))].position =
          palm(0).translation() + Vector3(0.1, 0, 0);
    HumanState people;
    people.people = {anna};
    people_.set(people, now_);
  }

  Pose palm(std::size_t hand) const {
    return links_[static_cast<std::size_t>(hands_of(robot_)[hand].palm)];
  }
  /// Sets the force of the world on each hand, world [N].
  void feel(const std::array<Vector3, 2>& force) {
    state_.wrist_wrench.force = palm(0).linear().transpose() * force[0];
    state_.other_hands[0].wrist_wrench.force = palm(1).linear().transpose() * force[1];
  }
  void release_on_pull(bool both) {
    const auto all = hands_of(robot_);
    for (std::size_t i = 0; i < 2; ++i) {
      HandCommand command;
      command.id = i + 1;
      command.action = HandAction::release_on_pull;
      command.group = all[i].fingers->name;
      command.position = RobotModel::part(robot_.rest_configuration(), *all[i].fingers);
      command.pull_force = kPullForce;
      command.both_hands = both;
      ASSERT_EQ(hands_.accept(command, "", on_path_), "");
      run(0.05);
    }
  }
  std::array<HandState, 2> states() const {
    ExecutionStatus status;
    hands_.report(status);
    return {status.hand, status.other_hands.at(0).hand};
  }
  /// Runs the hands, and notes the first step in which each of them opens.
  void run(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / kPeriod); ++k) {
      now_ += from_seconds(kPeriod);
      state_.position = next_.position;
      hands_.step({state_, people_, links_, true, on_path_, Mode::normal, false}, now_, next_);
      ++step_;
      for (std::size_t i = 0; i < 2; ++i) {
        const bool opens = states()[i] == HandState::moving || states()[i] == HandState::released;
        if (opens && opened_[i] == 0) opened_[i] = step_;
      }
    }
  }

  RobotModel robot_;
  Hands hands_;
  ObservedPeople people_;
  std::vector<char> on_path_;
  RobotState state_;
  std::vector<Pose> links_;
  MotionState3 next_;
  TimePoint now_{};
  int step_{0};
  std::array<int, 2> opened_{};
  const Vector3 half_{0, 0, -15}, pull_{3, 0, 0};  // of the load, of the pull on each hand [N]
};

TEST_F(BothHandsTest, open_at_the_same_time_at_a_pull_that_only_both_together_feel) {
  feel({half_, half_});
  release_on_pull(true);
  run(1.0);
  EXPECT_EQ(opened_, (std::array<int, 2>{0, 0}));
  feel({half_ + pull_, half_ + pull_});
  run(2.0);
  EXPECT_GT(opened_[0], 0);
  EXPECT_EQ(opened_[0], opened_[1]);
  EXPECT_EQ(states()[0], HandState::released);
  EXPECT_EQ(states()[1], HandState::released);
}

TEST_F(BothHandsTest, each_alone_does_not_open_at_half_of_that_pull) {
  feel({half_, half_});
  release_on_pull(false);
  run(1.0);
  feel({half_ + pull_, half_ + pull_});
  run(2.0);
  EXPECT_EQ(opened_, (std::array<int, 2>{0, 0}));
}

TEST_F(BothHandsTest, keep_hold_where_the_arms_press_the_object_or_shift_its_load) {
  feel({half_, half_});
  release_on_pull(true);
  run(1.0);
  const Vector3 against(0, 8, 0), more(0, 0, -5);
  feel({half_ + against + more, half_ - against - more});
  run(3.0);
  EXPECT_EQ(opened_, (std::array<int, 2>{0, 0}));
}

}  // namespace
}  // namespace handsel::trajectory_controller::both_hands_test
