// SPDX-License-Identifier: Apache-2.0
// The computed reach of an arm against distances of sampled configurations.
#include "common/model/arm_reach.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/config/resources.hpp"
#include "common/model/manipulator.hpp"

namespace handsel::arm_reach_test {
namespace {

constexpr unsigned kSeed = 20;
constexpr int kConfigurations = 4000;
// Min ratio of sampled and computed reach: an elbow offset shortens the stretched arm.
constexpr double kMinReached = 0.85;

/// Returns the max distance from shoulder to palm among random configurations [m].
double longest(const RobotModel& robot, const Manipulator& arm, int shoulder) {
  std::mt19937 random(kSeed);
  Vector q = robot.rest_configuration();
  double longest = 0;
  for (int n = 0; n < kConfigurations; ++n) {
    for (const int axis : arm.arm->axes) {
      const Axis& a = robot.axes()[static_cast<std::size_t>(axis)];
      q[axis] = std::uniform_real_distribution(a.lower, a.upper)(random);
    }
    const Vector3 p_palm = robot.link_pose(q, arm.palm).translation();
    longest = std::max(longest, (p_palm - robot.link_pose(q, shoulder).translation()).norm());
  }
  return longest;
}

TEST(ArmReach, the_palm_gets_about_as_far_as_the_reach_says_and_no_farther) {
  for (const std::string name : {"jido", "duo"}) {
    const auto file = resource("robots/" + name + "/" + name + ".txtpb");
    const RobotModel robot = RobotModel::load(file);
    for (const Manipulator& arm : manipulators(file, robot)) {
      const ArmReach reach = arm_reach(robot, arm.arm, arm.palm);
      ASSERT_GE(reach.shoulder, 0) << name;
      const double reached = longest(robot, arm, reach.shoulder);
      std::printf("%-7s %-10s %.3f m of %.3f m, seed %u\n", name.c_str(), arm.name.c_str(), reached,
                  reach.length - kObjectBeyondTool, kSeed);
      const double to_palm = reach.length - kObjectBeyondTool;
      EXPECT_LE(reached, to_palm + 1e-9) << name << " " << arm.name;
      EXPECT_GE(reached, kMinReached * to_palm) << name << " " << arm.name;
    }
  }
}

}  // namespace
}  // namespace handsel::arm_reach_test
