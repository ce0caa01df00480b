// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/guard.hpp"

#include <gtest/gtest.h>

#include "common/trajectory/stop.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::trajectory_controller::guard_test {
namespace {

class GuardTest : public testing::Test {
 protected:
  GuardTest()
      : robot_(test::small_robot()),
        capsules_(robot_capsules(*robot_)),
        q_(Vector::Zero(robot_->dof())),
        dq_(q_),
        ddq_(q_) {
    settings_.speed_floor = 0.1;
    settings_.speed_uncertainty = 0.0;
  }
  Person standing(double x, double y = 0.0) const {
    Person p;
    p.id = "anna";
    p.joints = standing_body(Vector3(x, y, 0), M_PI, 1.75);
    return p;
  }
  GuardVerdict judge(const HumanState& people, double age = 0.0, double factor = 1.0,
                     const SeparationExemption& exception = {}) {
    prepare(people, exception, settings_.unknown_after, crowd_);
    robot_->forward(q_, links_);
    link_twists(*robot_, dq_, links_, twists_);
    const PathMotion motion{&dq_, &ddq_, &links_, &twists_};
    return guard(motion, crowd_, age, factor);
  }
  GuardVerdict guard(const PathMotion& motion, const PersonCapsules& people, double age,
                     double factor) {
    const StopTable stop = stop_table(motion, robot_->stop_limits());
    const Pose base = Pose::Identity();
    return trajectory_controller::guard(
        settings_, {capsules_, motion, stop, base, people, walls_, age, factor});
  }
  GuardVerdict judge(const Person& person, double age = 0.0, double factor = 1.0,
                     const SeparationExemption& exception = {}) {
    return judge(HumanState{0, {person}, true}, age, factor, exception);
  }
  static void walk(Person& p, const Vector3& velocity) {
    for (BodyJoint& j : p.joints) j.velocity = velocity;
  }
  /// Swings the arm, stretched to the front left, toward +x and a person in front.
  void swing(double speed) {
    q_[0] = 1.2;
    dq_[0] = -speed;
  }

  std::shared_ptr<const RobotModel> robot_;
  std::vector<LinkCapsule> capsules_;
  std::vector<Pose> links_;
  std::vector<LinkTwist> twists_;
  std::vector<Wall> walls_;
  Vector q_, dq_, ddq_;
  GuardSettings settings_;
  PersonCapsules crowd_;
};

TEST(SeparationReference, vectors_of_the_constant_deceleration_form) {
  const double s[] = {0.34, 0.5, 1.0, 1.5, 2.0}, v[] = {0.0, 0.1616, 0.6000, 0.9723, 1.3016};
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(reference_speed(s[i], 1.6, 0.15, 2.0, 0.1), v[i], 5e-5) << s[i];
  const double s2[] = {0.5, 1.0, 2.0}, v2[] = {0.3729, 1.2088, 2.4497};
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(reference_speed(s2[i], 1.6, 0.12, 5.0, 0.13), v2[i], 5e-5) << s2[i];
  EXPECT_EQ(reference_speed(0.05, 0.1, 0.1, 2.0, 0.5), 0.0);
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

TEST_F(GuardTest, says_where_the_nearest_person_is_and_what_the_rule_asks_for_there) {
  Person p = standing(1.6);
  const double margin =
      settings_.intrusion + settings_.uncertainty_human + settings_.uncertainty_robot;
  const GuardVerdict rest = judge(p, 0.02);
  EXPECT_LT(rest.distance, 1.6);
  const double axes_apart = (rest.on_robot - rest.on_person).norm();
  EXPECT_GT(axes_apart, rest.distance);
  EXPECT_LT(axes_apart, rest.distance + 0.4);  // two radii
  EXPECT_NEAR(rest.needed, 0.1 * (settings_.reaction + 0.02) + margin, 1e-12);
  walk(p, Vector3(-0.5, 0, 0));
  EXPECT_GT(judge(p, 0.02).needed, rest.needed);
  swing(1.0);
  const double slow = judge(p, 0.02, 0.25).needed, fast = judge(p, 0.02, 1.0).needed;
  EXPECT_GT(fast, slow);
  EXPECT_EQ(judge(HumanState{0, {}, true}).distance, 1e9);
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
  // Oracle: both continue for the reaction time, then the axis stops in minimum time while the
  // person continues.
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
      const StopMeasure stop = measure_stop(speed, 0.0, robot_->stop_limits().acceleration[0],
                                            robot_->stop_limits().jerk[0]);
      Vector end = q_;
      end[0] -= speed * settings_.reaction + stop.distance;
      Person later = p;
      for (BodyJoint& j : later.joints)
        j.position.x() -= v_h * (settings_.reaction + stop.duration);
      std::vector<Pose> links;
      robot_->forward(end, links);
      EXPECT_GT(
          separation(capsules_, links, Pose::Identity(), HumanState{0, {later}, true}).distance,
          0.0)
          << x << " " << v_h;
    }
  EXPECT_GT(limited, 5);
}

TEST_F(GuardTest, older_data_allow_less) {
  swing(0.5);
  Person p = standing(1.15);
  walk(p, Vector3(-0.8, 0, 0));
  EXPECT_LT(judge(p, 0.15).forward, judge(p, 0.0).forward);
}

TEST_F(GuardTest, moving_clearly_away_is_not_held_back_and_running_back_is) {
  swing(0.5);
  q_[0] = 0.9;
  dq_[0] = 0.5;
  Person p = standing(1.0);
  walk(p, Vector3(-1.5, 0, 0));
  const GuardVerdict v = judge(p);
  EXPECT_EQ(v.forward, 1.0);
  EXPECT_GT(v.backward, -0.2);
  EXPECT_FALSE(v.too_near);
}

TEST_F(GuardTest, how_clearly_a_link_must_lead_away_is_a_setting) {
  q_[0] = 0.9;
  dq_[0] = 0.5;
  Person p = standing(1.0);
  walk(p, Vector3(-1.5, 0, 0));
  EXPECT_EQ(judge(p).forward, 1.0);
  settings_.away_ratio = 1.0;
  EXPECT_LT(judge(p).forward, 1.0);
}

TEST_F(GuardTest, what_leads_past_a_person_is_held_back_both_ways_the_faster_they_come) {
  swing(0.5);
  q_[0] = 0.2;
  Person p = standing(1.15);
  const double still = judge(p).forward;
  walk(p, Vector3(-1.5, 0, 0));
  const GuardVerdict fast = judge(p);
  EXPECT_LT(fast.forward, still);
  EXPECT_LT(fast.forward, 0.5);
  EXPECT_GT(fast.backward, -0.5);
}

TEST_F(GuardTest, a_person_not_seen_just_now_counts_as_walking_in) {
  swing(0.5);
  Person p = standing(1.5);
  const double seen = judge(p).forward;
  p.age = 0.5;
  EXPECT_LT(judge(p).forward, seen);
}

TEST_F(GuardTest, the_time_since_a_person_was_seen_counts_like_a_person_that_much_nearer) {
  swing(0.5);
  Person p = standing(1.15), older = p;
  for (Person* person : {&p, &older}) walk(*person, Vector3(-0.8, 0, 0));
  older.age = 0.2;
  const GuardVerdict now = judge(p), then = judge(older);
  EXPECT_LT(then.forward, now.forward);
  Person nearer = p;  // extrapolated to the present
  for (BodyJoint& j : nearer.joints) j.position.x() -= 0.8 * older.age;
  EXPECT_LE(then.forward, judge(nearer).forward + 0.02);
  older.inflation = 0.16;  // the volumes contain the extrapolation
  EXPECT_NEAR(judge(older).forward, then.forward, 0.05) << "once, not twice";
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
  const GuardVerdict engaged = judge(p, 0.0, 1.0, SeparationExemption{"anna", Side::right, true});
  EXPECT_GT(engaged.forward, before.forward);
  EXPECT_FALSE(engaged.handover_clear);
  EXPECT_LE(engaged.forward * 0.5 * 0.8, settings_.handover_speed * 1.3);
  EXPECT_DOUBLE_EQ(judge(p, 0.0, 1.0, SeparationExemption{"bert", Side::right, true}).forward,
                   before.forward);
  EXPECT_DOUBLE_EQ(judge(p, 0.0, 1.0, SeparationExemption{"anna", Side::left, false}).forward,
                   before.forward);
}

TEST_F(GuardTest,
       only_the_part_of_the_exchanging_hand_within_range_counts_and_its_speed_is_capped_both_ways) {
  q_[0] = 0.25;
  Person p = standing(1.5);
  p.joints[9].position = Vector3(1.25, -0.1, 1.0);
  p.joints[10].position = Vector3(1.0, 0, 1.0);
  p.joints[11].position = Vector3(0.92, 0, 1.0);
  const SeparationExemption exchange{"anna", Side::right, true};
  dq_[0] = 3.0;
  const GuardVerdict leaving = judge(p, 0.0, 1.0, exchange);
  EXPECT_GT(leaving.backward, -0.5) << "running back would close in too fast";
  EXPECT_FALSE(leaving.handover_clear);
  dq_[0] = -0.1;
  EXPECT_FALSE(judge(p, 0.0, 1.0, exchange).handover_clear) << "near, slow enough";
  settings_.handover_range = 0.01;
  EXPECT_TRUE(judge(p, 0.0, 1.0, exchange).handover_clear);
}

TEST_F(GuardTest, overlapping_a_person_and_parts_without_length_are_judged_too) {
  const int upper = robot_->link_index("upper");
  capsules_ = {LinkCapsule{upper, Vector3(0.4, 0, 0), Vector3(0.4, 0, 0), 0.05}};
  q_[0] = 0.0;
  dq_[0] = 0.5;
  Person p = standing(0.4);
  const GuardVerdict inside = judge(p);
  EXPECT_LT(inside.distance, 0.0);
  dq_[0] = 0.0;
  EXPECT_EQ(judge(p).forward, 1.0) << "what does not move is not slowed";
  robot_->forward(q_, links_);
  const Vector3 there = links_[static_cast<std::size_t>(upper)] * Vector3(0.4, 0, 0);
  PersonCapsules point;
  point.covered = true;
  point.capsules.emplace_back();
  PersonCapsule& c = point.capsules.back();
  c.a = there;
  c.b = there;
  c.centre = there;
  c.radius = 0.1;
  c.reach = 0.1;
  dq_[0] = 0.0;
  dq_[1] = -0.5;
  link_twists(*robot_, dq_, links_, twists_);
  const PathMotion motion{&dq_, &ddq_, &links_, &twists_};
  const GuardVerdict same = guard(motion, point, 0.0, 1.0);
  EXPECT_EQ(same.forward, 0.0)
      << "the nearest points coincide: up is taken as the way, and up it goes";
}

TEST_F(GuardTest, a_wall_ahead_slows_until_the_stop_ends_before_it_and_one_behind_does_not) {
  // Oracle: reaction time at speed, then the minimum-time stop of the axis; the tip does not pass
  // the wall.
  swing(0.5);
  int limited = 0;
  for (double x = 0.35; x < 0.9; x += 0.01) {
    walls_ = {Wall{-Vector3::UnitX(), -x}};  // the robot stays at smaller x
    const GuardVerdict v = judge(HumanState{0, {}, true});
    EXPECT_EQ(v.wall, v.forward < 1.0 || v.backward > -1.0);
    EXPECT_FALSE(v.separation);
    if (v.forward >= 1.0 || v.forward <= 0.0) continue;
    ++limited;
    const double speed = v.forward * 0.5;
    const StopMeasure stop = measure_stop(speed, 0.0, robot_->stop_limits().acceleration[0],
                                          robot_->stop_limits().jerk[0]);
    Vector end = q_;
    end[0] -= speed * settings_.reaction + stop.distance;
    std::vector<Pose> links;
    robot_->forward(end, links);
    for (const LinkCapsule& link : capsules_) {
      if (link.link != robot_->link_index("upper") && link.link != robot_->link_index("lower"))
        continue;
      EXPECT_LT((links[static_cast<std::size_t>(link.link)] * link.b).x() + link.radius, x + 1e-9)
          << x;
    }
  }
  EXPECT_GT(limited, 2);
  walls_ = {Wall{-Vector3::UnitX(), -0.2}};
  EXPECT_EQ(judge(HumanState{0, {}, true}).forward, 0.0) << "beyond the wall already: no further";
  EXPECT_EQ(judge(HumanState{0, {}, true}).backward, -1.0) << "but back";
  walls_ = {Wall{Vector3::UnitX(), -5.0}};
  EXPECT_EQ(judge(HumanState{0, {}, true}).backward, -1.0);
}

TEST_F(GuardTest, walls_and_people_combine_by_the_least) {
  swing(0.5);
  Person p = standing(1.2);
  walk(p, Vector3(-0.8, 0, 0));
  const double person_alone = judge(p).forward;
  walls_ = {Wall{-Vector3::UnitX(), -0.5}};
  const double wall_alone = judge(HumanState{0, {}, true}).forward;
  EXPECT_EQ(judge(p).forward, std::min(person_alone, wall_alone));
}

TEST_F(GuardTest, link_velocities_are_those_of_the_poses) {
  q_ << 0.4, 0.3, -0.6, 0.2, 0.1, 0.5, -0.1;
  dq_ << 0.5, -0.4, 0.3, 1.0, -0.5, 0.2, 0.1;
  constexpr double kStep = 1e-6;
  std::vector<Pose> later;
  robot_->forward(q_, links_);
  robot_->forward(q_ + kStep * dq_, later);
  link_twists(*robot_, dq_, links_, twists_);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Vector3 p(0.1, -0.2, 0.3), r = links_[i].linear() * p;
    const Vector3 v = (later[i] * p - links_[i] * p) / kStep;
    EXPECT_TRUE((twists_[i].linear + twists_[i].angular.cross(r)).isApprox(v, 1e-4) ||
                v.norm() < 1e-9)
        << i;
  }
}

TEST_F(GuardTest, slow_approach_near_the_torso_is_allowed) {
  swing(0.5);
  q_[0] = 0.5;
  const GuardVerdict v = judge(standing(1.28));
  EXPECT_LT(v.distance, 0.45);
  EXPECT_GT(v.forward, 0.2);
}

}  // namespace
}  // namespace handsel::trajectory_controller::guard_test
