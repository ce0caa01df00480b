// SPDX-License-Identifier: Apache-2.0
// Fingers that move beside a face: no set-point is replaced by one of a stop, and the arm stays on
// its path.
#include "components/trajectory_controller/supervise/finger_limit.hpp"

#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "components/trajectory_controller/controller.hpp"
#include "tests/support/processes/live_view.hpp"

namespace handsel::trajectory_controller::finger_limit_test {
namespace {

/// Jido at rest, opposite a person at `distance` from its hand [m].
class FingersBesideSomebody {
 public:
  explicit FingersBesideSomebody(double distance)
      : robot_(std::make_shared<const RobotModel>(RobotModel::load(robot_description("jido")))),
        core_({}, robot_) {
    state_.robot = robot_->name();
    state_.position = robot_->rest_configuration();
    state_.velocity = state_.effort = Vector::Zero(robot_->dof());
    state_.mode = DriveMode::enabled;
    std::vector<Pose> links;
    robot_->forward(state_.position, links);
    Vector3 feet = links[static_cast<std::size_t>(robot_->tool_link())].translation() +
                   Vector3(distance, 0, 0);
    feet.z() = 0;
    Person person;
    person.id = "anna";
    person.joints = standing_body(feet, M_PI, 1.75);
    people_.covered = true;
    people_.views = {test::live_view()};
    people_.people = {person};
    Go first;  // permits no motion: the controller requires a newer one
    first.state_revision = 1;
    core_.on(first, now_);
    go_.state_revision = 2;
    go_.epoch = 1;
    go_.allowed = true;
    run(0.2);
  }

  void run(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds * 1000); ++k, ++ticks_) {
      now_ += std::chrono::milliseconds(1);
      if (ticks_ % 2 == 0) {
        if (core_.set_point().position.size() == state_.position.size() && ticks_ > 10)
          state_.position = core_.set_point().position;
        ++state_.sequence;
        core_.on(state_, now_);
      }
      if (ticks_ % 33 == 0) core_.on(people_, now_);
      if (ticks_ % 50 == 0) core_.on(go_, now_);
      if (ticks_ % 20 == 0) {
        core_.on(AttentionAdvice{}, now_);
        core_.on(TrajectoryForecast{}, now_);
      }
      core_.step(now_, false);
    }
  }
  std::string open() {
    HandCommand c;
    c.robot = robot_->name();
    c.id = ++id_;
    c.epoch = 1;
    const std::vector<int>& axes = robot_->require_group("hand").axes;
    c.position = Vector::Zero(static_cast<Eigen::Index>(axes.size()));
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Axis& axis = robot_->axes()[static_cast<std::size_t>(axes[i])];
      const double at = core_.set_point().position[axes[i]];
      c.position[static_cast<Eigen::Index>(i)] =
          at < 0.5 * (axis.lower + axis.upper) ? axis.upper - 0.1 : axis.lower + 0.1;
    }
    return core_.accept(c, Duration(0), now_);
  }
  std::string draw_back() {
    const Group& arm = robot_->require_group("arm");
    const auto of_arm = [&](const Vector& v) { return RobotModel::part(v, arm); };
    const KinematicLimits& l = robot_->comfort_limits();
    TrajectoryCommand c;
    c.robot = robot_->name();
    c.id = ++id_;
    c.epoch = 1;
    c.axes.assign(arm.axes.begin(), arm.axes.end());
    const Vector from = of_arm(core_.set_point().position);
    Vector goal = from;
    goal[0] += 0.6;
    c.trajectory = solve(rest_state(from), rest_state(goal),
                         {of_arm(l.velocity), of_arm(l.acceleration), of_arm(l.jerk)})
                       .trajectory;
    return core_.accept(c, Duration(0), now_);
  }
  /// Moves the person along x [m].
  void shift_person(double x) {
    for (BodyJoint& joint : people_.people[0].joints) joint.position.x() += x;
  }
  /// The tracker reports that the person moves along x [m/s].
  void set_velocity(double x) {
    for (BodyJoint& joint : people_.people[0].joints) joint.velocity = Vector3(x, 0, 0);
  }
  const Controller& core() const { return core_; }

 private:
  std::shared_ptr<const RobotModel> robot_;
  Controller core_;
  TimePoint now_{from_seconds(10)};
  RobotState state_;
  HumanState people_;
  Go go_;
  std::uint64_t id_{};
  long ticks_{};
};

TEST(FingerLimit, opening_beside_a_face_needs_no_stop) {
  for (double distance = 0.3; distance < 1.0; distance += 0.05) {
    FingersBesideSomebody b(distance);
    ASSERT_EQ(b.open(), "");
    b.run(4.0);
    EXPECT_EQ(b.core().unproven_set_points(), 0u) << "somebody at " << distance << " m";
    EXPECT_EQ(b.core().status().hand, HandState::idle)
        << "the hand has not opened, somebody at " << distance << " m";
  }
}

TEST(FingerLimit, fingers_wait_while_somebody_rushes_at_the_hand) {
  FingersBesideSomebody b(0.6);
  ASSERT_EQ(b.open(), "");
  b.run(0.2);
  ASSERT_GT(b.core().set_point().velocity.norm(), 0.05) << "the hand opens";
  b.set_velocity(-1.6);
  b.run(0.3);
  EXPECT_LT(b.core().set_point().velocity.norm(), 1e-9);
  EXPECT_EQ(b.core().status().hand, HandState::moving);
  b.set_velocity(0);
  b.run(4.0);
  EXPECT_EQ(b.core().status().hand, HandState::idle) << "the hand goes on afterwards";
}

TEST(FingerLimit, the_arm_leaves_its_path_for_no_finger) {
  for (double distance = 0.45; distance < 1.0; distance += 0.05) {
    FingersBesideSomebody b(distance);
    ASSERT_EQ(b.draw_back(), "");
    b.run(0.1);
    ASSERT_EQ(b.open(), "");
    b.run(20.0);
    EXPECT_EQ(b.core().unproven_set_points(), 0u) << "somebody at " << distance << " m";
    EXPECT_EQ(b.core().status().motion, MotionState::finished)
        << "somebody at " << distance << " m";
  }
}

// The allowed speed depends on the arm's acceleration: an arm that accelerates at once after a stop
// by a person would be stopped again.
TEST(FingerLimit, after_a_person_has_stopped_the_arm_the_path_gathers_speed_slowly) {
  for (const double distance : {0.55, 0.6, 0.65}) {
    FingersBesideSomebody b(distance);
    ASSERT_EQ(b.draw_back(), "");
    b.run(0.3);
    b.shift_person(-0.15);
    b.run(0.1);
    b.shift_person(0.15);
    double last = b.core().speed_factor(), max_rise = 0.0, max_factor = 0.0;
    bool has_stopped = false;
    for (int k = 0; k < 20000 && b.core().status().motion == MotionState::running; ++k) {
      b.run(0.001);
      const double factor = b.core().speed_factor();
      has_stopped = has_stopped || factor < 0.01;
      if (has_stopped) max_rise = std::max(max_rise, factor - last);
      if (has_stopped) max_factor = std::max(max_factor, factor);
      last = factor;
    }
    EXPECT_TRUE(has_stopped);
    EXPECT_GT(max_factor, 0.5);
    EXPECT_LT(max_rise, 0.004) << "with somebody at " << distance << " m";
    EXPECT_EQ(b.core().status().motion, MotionState::finished);
  }
}

}  // namespace
}  // namespace handsel::trajectory_controller::finger_limit_test
