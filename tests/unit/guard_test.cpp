#include "components/trajectory_controller/guard.hpp"

#include <gtest/gtest.h>

#include "common/trajectory/stop.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::trajectory_controller {
namespace {

class GuardTest : public testing::Test {
 protected:
  GuardTest() : robot_(test::small_robot()), capsules_(robot_capsules(*robot_)), q_(Vector::Zero(robot_->dof())), dq_(q_), ddq_(q_) {
    settings_.speed_floor = 0.1;
    settings_.speed_uncertainty = 0.0;
  }
  Person standing(double x, double y = 0.0) const {
    Person p;
    p.id = "anna";
    p.joints = standing_body(Vector3(x, y, 0), M_PI, 1.75);
    return p;
  }
  GuardVerdict judge(const HumanState& people, double age = 0.0, double factor = 1.0, const Exception& exception = {}) {
    prepare(people, exception, settings_.unknown_after, crowd_);
    PathMotion motion{&dq_, &ddq_, &links_, &ahead_};
    robot_->forward(q_, links_);
    robot_->forward(q_ + motion.look * dq_, ahead_);
    return guard(settings_, capsules_, motion, Pose::Identity(), robot_->stop_limits(), crowd_, age, factor);
  }
  GuardVerdict judge(const Person& person, double age = 0.0, double factor = 1.0, const Exception& exception = {}) {
    return judge(HumanState{0, {person}, true}, age, factor, exception);
  }
  static void walk(Person& p, const Vector3& velocity) {
    for (BodyJoint& j : p.joints) j.velocity = velocity;
  }
  /// The arm stretched to the front-left swings toward +x: closing in on somebody in front.
  void swing(double speed) {
    q_[0] = 1.2;
    dq_[0] = -speed;
  }

  std::shared_ptr<const RobotModel> robot_;
  std::vector<LinkCapsule> capsules_;
  std::vector<Pose> links_, ahead_;
  Vector q_, dq_, ddq_;
  GuardSettings settings_;
  Crowd crowd_;
};

TEST(SeparationReference, vectors_of_the_constant_deceleration_form) {
  const double s[] = {0.34, 0.5, 1.0, 1.5, 2.0}, v[] = {0.0, 0.1616, 0.6000, 0.9723, 1.3016};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(reference_speed(s[i], 1.6, 0.15, 2.0, 0.1), v[i], 5e-5) << s[i];
  const double s2[] = {0.5, 1.0, 2.0}, v2[] = {0.3729, 1.2088, 2.4497};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(reference_speed(s2[i], 1.6, 0.12, 5.0, 0.13), v2[i], 5e-5) << s2[i];
}

TEST(StopTime, agrees_with_the_critical_movement) {
  EXPECT_NEAR(stop_time(0.475, 0.95, 2.85), 0.475 / 0.95 + 0.95 / 2.85, 1e-12);
  for (double v : {0.01, 0.1, 0.3, 0.475, 2.0}) {
    const StopMeasure exact = measure_stop(v, 0.0, 0.95, 2.85);
    EXPECT_NEAR(stop_time(v, 0.95, 2.85), exact.duration, 1e-9) << v;
    EXPECT_NEAR(0.5 * v * stop_time(v, 0.95, 2.85), exact.distance, 1e-9) << v;
  }
}

TEST_F(GuardTest, nobody_and_covered_is_full_speed_both_ways) {
  swing(0.5);
  const GuardVerdict v = judge(HumanState{0, {}, true});
  EXPECT_EQ(v.forward, 1.0);
  EXPECT_EQ(v.backward, -1.0);
  EXPECT_FALSE(v.separation || v.uncovered || v.too_near);
}

TEST_F(GuardTest, nobody_but_not_covered_is_slow) {
  swing(0.5);
  const GuardVerdict v = judge(HumanState{0, {}, false});
  EXPECT_EQ(v.forward, settings_.uncovered_factor);
  EXPECT_TRUE(v.uncovered);
}

TEST_F(GuardTest, a_person_standing_still_well_out_of_reach_changes_nothing) {
  swing(0.5);
  const GuardVerdict v = judge(standing(1.9));
  EXPECT_EQ(v.forward, 1.0);
  EXPECT_GT(v.distance, 0.3);
}

TEST_F(GuardTest, the_allowed_speed_grows_with_distance_and_obeys_the_rule) {
  swing(0.5);
  double last = -1.0;
  for (double x = 0.9; x < 2.2; x += 0.05) {
    Person p = standing(x);
    walk(p, Vector3(-0.8, 0, 0));
    const double forward = judge(p).forward;
    EXPECT_GE(forward, last - 1e-9) << x;
    last = forward;
  }
  EXPECT_EQ(last, 1.0);
}

TEST_F(GuardTest, at_the_allowed_speed_the_robot_stops_before_it_meets_the_person) {
  // Oracle: both walk on for the reaction time, then the axis stops in minimum time while the person walks on.
  swing(0.5);
  int limited = 0;
  for (double x = 1.0; x < 2.0; x += 0.05)
    for (double v_h : {0.1, 0.4, 0.8, 1.6}) {
      Person p = standing(x);
      walk(p, Vector3(-v_h, 0, 0));
      const double factor = judge(p).forward;
      if (factor >= 1.0 || factor <= 0.0) continue;
      ++limited;
      const double speed = factor * 0.5;
      const StopMeasure stop = measure_stop(speed, 0.0, robot_->stop_limits().acceleration[0], robot_->stop_limits().jerk[0]);
      Vector end = q_;
      end[0] -= speed * settings_.reaction + stop.distance;
      Person later = p;
      for (BodyJoint& j : later.joints) j.position.x() -= v_h * (settings_.reaction + stop.duration);
      std::vector<Pose> links;
      robot_->forward(end, links);
      EXPECT_GT(separation(capsules_, links, Pose::Identity(), HumanState{0, {later}, true}).distance, 0.0) << x << " " << v_h;
    }
  EXPECT_GT(limited, 5);
}

TEST_F(GuardTest, older_data_allow_less) {
  swing(0.5);
  Person p = standing(1.15);
  walk(p, Vector3(-0.8, 0, 0));
  EXPECT_LT(judge(p, 0.15).forward, judge(p, 0.0).forward);
}

TEST_F(GuardTest, moving_away_is_never_held_back_and_running_back_is) {
  swing(0.5);
  q_[0] = 0.5;
  dq_[0] = 0.5;
  Person p = standing(1.25);
  walk(p, Vector3(-1.0, 0, 0));
  const GuardVerdict v = judge(p);
  EXPECT_EQ(v.forward, 1.0);
  EXPECT_GT(v.backward, -0.2);
  EXPECT_FALSE(v.too_near);
}

TEST_F(GuardTest, a_person_not_seen_just_now_counts_as_walking_in) {
  swing(0.5);
  Person p = standing(1.5);
  const double seen = judge(p).forward;
  p.age = 0.5;
  EXPECT_LT(judge(p).forward, seen);
}

TEST_F(GuardTest, measured_speed_is_capped_and_has_a_floor) {
  swing(0.5);
  Person fast = standing(1.9), capped = standing(1.9);
  walk(fast, Vector3(-1e4, 0, 0));
  walk(capped, Vector3(-1e3, 0, 0));
  EXPECT_DOUBLE_EQ(judge(fast).forward, judge(capped).forward);
  Person leaving = standing(1.2), still = standing(1.2);
  walk(leaving, Vector3(2.0, 0, 0));
  EXPECT_DOUBLE_EQ(judge(leaving).forward, judge(still).forward);
}

TEST_F(GuardTest, too_near_for_the_stop_is_told_only_while_closing_in) {
  swing(0.5);
  Person p = standing(1.02);
  walk(p, Vector3(-1.5, 0, 0));
  EXPECT_TRUE(judge(p, 0.0, 1.0).too_near);
  EXPECT_FALSE(judge(p, 0.0, 0.0).too_near);
}

TEST_F(GuardTest, the_exchanging_hand_is_excepted_but_its_speed_stays_limited) {
  q_[0] = 0.25;
  dq_[0] = -0.5;
  Person p = standing(1.5);
  p.joints[9].position = Vector3(1.25, -0.1, 1.0);
  p.joints[10].position = Vector3(1.0, 0, 1.0);
  p.joints[11].position = Vector3(0.92, 0, 1.0);
  const GuardVerdict before = judge(p);
  const GuardVerdict engaged = judge(p, 0.0, 1.0, Exception{"anna", Side::right, true});
  EXPECT_GT(engaged.forward, before.forward);
  EXPECT_FALSE(engaged.exchange_clear);
  EXPECT_LE(engaged.forward * 0.5 * 0.8, settings_.exchange_speed * 1.3);
  EXPECT_DOUBLE_EQ(judge(p, 0.0, 1.0, Exception{"bert", Side::right, true}).forward, before.forward);
  EXPECT_DOUBLE_EQ(judge(p, 0.0, 1.0, Exception{"anna", Side::left, false}).forward, before.forward);
}

TEST_F(GuardTest, slow_approach_near_the_torso_is_allowed) {
  swing(0.5);
  q_[0] = 0.5;
  const GuardVerdict v = judge(standing(1.28));
  EXPECT_LT(v.distance, 0.45);
  EXPECT_GT(v.forward, 0.2);
}

}  // namespace
}  // namespace handsel::trajectory_controller
