// SPDX-License-Identifier: Apache-2.0
// A mobile robot: its description extends another one, and place and heading of the platform are
// its last axes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "common/model/description/robot_text.hpp"
#include "common/model/platform.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::driving_robot_test {
namespace {

using test::message_of;
using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kRobots = std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/";
const std::string kJido = kRobots + "jido/jido.txtpb";
const std::string kMobile = kRobots + "jido_mobile/jido_mobile.txtpb";

TEST(DrivingRobot, has_the_axes_of_the_platform_after_all_others) {
  const RobotModel standing = RobotModel::load(kJido), driving = RobotModel::load(kMobile);
  EXPECT_FALSE(drives(standing));
  ASSERT_TRUE(drives(driving));
  ASSERT_EQ(driving.dof(), standing.dof() + 3);
  for (int i = 0; i < standing.dof(); ++i)
    EXPECT_EQ(driving.axes()[i].name, standing.axes()[i].name);
  EXPECT_EQ(driving.require_group(kPlatformGroup).axes,
            (std::vector<int>{standing.dof(), standing.dof() + 1, standing.dof() + 2}));
  EXPECT_EQ(driving.hand(), standing.hand());
  EXPECT_DOUBLE_EQ(driving.comfort_limits().velocity[standing.dof()], 0.5);
}

TEST(DrivingRobot, its_links_are_where_those_of_a_standing_robot_at_that_place_are) {
  const RobotModel standing = RobotModel::load(kJido), driving = RobotModel::load(kMobile);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(-1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose T_world_base =
        make_pose({5 * within(random), 5 * within(random), 0},
                  Eigen::Quaterniond(Eigen::AngleAxisd(3 * within(random), Vector3::UnitZ())));
    Vector q = standing.rest_configuration();
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] += 0.2 * within(random);
    const Vector whole = with_platform(q, T_world_base);
    const Pose T_standing = T_world_base * standing.link_pose(q, standing.tool_link());
    const Pose T_driving = driving.link_pose(whole, driving.tool_link());
    EXPECT_LT((T_standing.matrix() - T_driving.matrix()).norm(), 1e-12);
    EXPECT_LT((T_world_platform(driving, whole, Pose::Identity()).matrix() - T_world_base.matrix())
                  .norm(),
              1e-12);
    EXPECT_EQ(T_world_platform(standing, q, T_world_base).matrix(), T_world_base.matrix());
    EXPECT_TRUE(with_platform_at(driving, whole, platform_place(driving, whole)) == whole);
  }
}

TEST(DrivingRobot, is_on_its_platform_already) {
  const RobotModel driving = RobotModel::load(kMobile);
  const auto mobile = on_platform(driving, kMobile);
  ASSERT_TRUE(mobile);
  EXPECT_EQ(mobile->dof(), driving.dof());
}

TEST(Extends, what_a_description_gives_itself_counts_and_paths_keep_their_meaning) {
  const config::RobotDescription text = read_robot_text(kMobile);
  EXPECT_EQ(text.name(), "jido_mobile");
  EXPECT_DOUBLE_EQ(text.platform().speed(), 0.5);
  EXPECT_TRUE(text.platform().drives());
  EXPECT_TRUE(std::filesystem::equivalent(text.urdf(), kRobots + "jido/jido.urdf"));
}

TEST(Extends, a_circle_and_a_missing_file_are_refused) {
  TemporaryFolder folder;
  const auto circle = folder.write("circle.txtpb", "name: \"a\"\nextends: \"circle.txtpb\"\n");
  EXPECT_THAT(message_of<ConfigError>([&] { read_robot_text(circle); }),
              AllOf(HasSubstr("circle.txtpb:2"), HasSubstr("must not form a circle")));
  const auto lost = folder.write("lost.txtpb", "name: \"a\"\nextends: \"nowhere.txtpb\"\n");
  EXPECT_THAT(message_of<MissingError>([&] { read_robot_text(lost); }),
              AllOf(HasSubstr("lost.txtpb:2"), HasSubstr("no file"), HasSubstr("nowhere.txtpb")));
}

}  // namespace
}  // namespace handsel::driving_robot_test
