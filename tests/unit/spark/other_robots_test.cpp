// SPDX-License-Identifier: Apache-2.0
// Other robots in SPARK: extrapolated poses, the nearest ones, silent ones.
#include "components/spark/robots/other_robots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "common/model/robot_volume.hpp"

namespace handsel::spark::other_robots_test {
namespace {

using ::testing::HasSubstr;

settings::SparkSettings with_margins() {
  settings::SparkSettings settings;
  settings.robot_margin = 0.03;
  settings.robot_ahead = 0.2;
  settings.robot_silent_after = 0.5;
  return settings;
}

RobotReport report(const std::string& robot, double x, double speed = 0) {
  RobotReport report;
  report.robot = robot;
  report.parts = {{{x, 0, 1}, {x, 0.4, 1}, 0.1, {speed, 0, 0}, {speed, 0, 0}}};
  return report;
}

const Coverage kReach{{-1, -1, 0}, {1, 1, 2}};
TimePoint at(double seconds) { return TimePoint(from_seconds(seconds)); }

TEST(OtherRobots, are_moved_on_by_their_velocity_and_larger_by_the_margin) {
  OtherRobots robots(with_margins(), "jido");
  robots.observe(report("left", 1.0, 0.5), at(10));
  const std::vector<OtherRobot> now = robots.robots(at(10.1), kReach);
  ASSERT_EQ(now.size(), 1u);
  EXPECT_EQ(now[0].name, "left");
  EXPECT_NEAR(now[0].age, 0.1, 1e-9);
  EXPECT_NEAR(now[0].parts[0].a.x(), 1.05, 1e-9);
  EXPECT_NEAR(now[0].parts[0].b.x(), 1.05, 1e-9);
  EXPECT_NEAR(now[0].parts[0].radius, 0.13, 1e-9);
  EXPECT_NEAR(now[0].parts[0].velocity_a.x(), 0.5, 1e-9);
}

TEST(OtherRobots, a_silent_one_stands_where_it_was_and_is_named) {
  OtherRobots robots(with_margins(), "jido");
  robots.observe(report("left", 1.0, 0.5), at(10));
  EXPECT_EQ(robots.trouble(at(10.4)), "");
  const std::vector<OtherRobot> later = robots.robots(at(60), kReach);
  ASSERT_EQ(later.size(), 1u) << "it is still there";
  EXPECT_NEAR(later[0].parts[0].a.x(), 1.1, 1e-9);
  EXPECT_EQ(later[0].parts[0].velocity_a.norm(), 0.0);
  EXPECT_THAT(robots.trouble(at(60)), HasSubstr("robot left has not been reported for 50 s"));
}

TEST(OtherRobots, neither_the_own_robot_nor_an_older_report_counts) {
  OtherRobots robots(with_margins(), "jido");
  robots.observe(report("jido", 1.0), at(10));
  EXPECT_TRUE(robots.robots(at(10), kReach).empty());
  robots.observe(report("left", 2.0), at(11));
  robots.observe(report("left", 1.0), at(10));
  EXPECT_NEAR(robots.robots(at(11), kReach).at(0).parts[0].a.x(), 2.0, 1e-9);
}

TEST(OtherRobots, of_many_the_nearest_are_kept_and_the_rest_is_counted) {
  OtherRobots robots(with_margins(), "jido");
  for (const double x : {9.0, 2.0, 7.0, 3.0, 5.0, 4.0})
    robots.observe(report("at_" + std::to_string(static_cast<int>(x)), x), at(1));
  LeftOut left_out;
  const std::vector<OtherRobot> nearest = robots.robots(at(1), kReach, &left_out);
  ASSERT_EQ(nearest.size(), 4u);
  EXPECT_EQ(nearest[0].name, "at_2");
  EXPECT_EQ(nearest[3].name, "at_5");
  EXPECT_EQ(left_out.count, 2u);
  EXPECT_NEAR(left_out.nearest, 6.9 - 0.03, 0.3);
}

TEST(RobotVolume, contains_the_links_and_moves_with_them) {
  const auto robot =
      std::make_shared<const RobotModel>(RobotModel::load(robot_description("jido")));
  RobotVolume volume(robot);
  const Vector q = robot->rest_configuration();
  Vector velocity = Vector::Zero(robot->dof());
  for (const int axis : robot->require_group("arm").axes) velocity[axis] = 0.3;
  EXPECT_TRUE(volume.fits(q));
  EXPECT_FALSE(volume.fits(q.head(3)));
  EXPECT_FALSE(volume.fits(Vector::Constant(q.size(), std::nan(""))));
  const Pose base = make_pose({1, 2, 0});
  const std::vector<MovingPart> now = volume.parts(q, velocity, base);
  constexpr double kLater = 0.01;
  const std::vector<MovingPart> later = volume.parts(q + kLater * velocity, velocity, base);
  ASSERT_EQ(now.size(), later.size());
  EXPECT_LE(now.size(), kMaxReportParts);
  double fastest = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    fastest = std::max(fastest, now[i].velocity_b.norm());
    EXPECT_LT((later[i].b - now[i].b - kLater * now[i].velocity_b).norm(), 1e-3);
  }
  EXPECT_GT(fastest, 0.1);
  const LinkCapsule hand = robot_capsules(*robot).back();
  std::vector<Pose> links;
  robot->forward(q, links);
  const Vector3 expected = base * links[static_cast<std::size_t>(hand.link)] * hand.a;
  const auto is_there = [&](const MovingPart& part) { return (part.a - expected).norm() < 1e-9; };
  EXPECT_TRUE(std::any_of(now.begin(), now.end(), is_there));
}

}  // namespace
}  // namespace handsel::spark::other_robots_test
