// SPDX-License-Identifier: Apache-2.0
// Straight motions of the tool in the running system: to a grasp with the fingers closing during
// the motion, up, down and away from the object (chapter section 4.6). In lock-step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "common/messages/execution.hpp"
#include "common/messages/names.hpp"
#include "common/messages/task.hpp"
#include "common/model/manipulator.hpp"
#include "common/trajectory/limits_check.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/edited_settings.hpp"

namespace handsel::tool_motions_test {
namespace {

/// A motion that the controller was given.
struct Commanded {
  ActionPhase phase{};
  double off_line{};  ///< largest distance of the tool from the line between the ends [m]
  double length{};    ///< of that line [m]
  double closed{};    ///< largest travel of a finger [rad]
};

/// Returns the motions of a give in the order in which they were commanded.
std::vector<Commanded> motions_of_a_give(const std::filesystem::path& settings = {}) {
  const NodeContext context = system_context("give_mug", "", 3, settings);
  const RobotModel& robot = *context.robot;
  const Manipulator hand = hands_of(robot).front();
  LockstepSystem system(context);
  std::vector<Commanded> motions;
  ActionStatus action;
  ActiveTrajectory active;
  system.bus().subscribe<ActionStatus>([&](const ActionStatus& m, const Receipt&) { action = m; });
  system.bus().subscribe<ActiveTrajectory>(
      [&](const ActiveTrajectory& m, const Receipt&) { active = m; });
  system.bus().subscribe<TrajectoryCommand>([&](const TrajectoryCommand& m, const Receipt&) {
    if (m.axes.empty() || m.switch_at > 0 || active.position.size() == 0) return;
    const auto tool_at = [&](double time) {
      Vector q = active.position;
      const Vector part = m.trajectory.at(time).position;
      for (std::size_t i = 0; i < m.axes.size(); ++i)
        q[m.axes[i]] = part[static_cast<Eigen::Index>(i)];
      return Vector3(robot.link_pose(q, hand.palm).translation());
    };
    constexpr int kParts = 50;
    const double duration = m.trajectory.duration();
    const Vector3 from = tool_at(0), line = tool_at(duration) - from;
    Commanded one{action.phase, 0, line.norm(), 0};
    for (int k = 1; k < kParts; ++k) {
      const Vector3 p = tool_at(duration * k / kParts) - from;
      one.off_line = std::max(one.off_line, p.cross(line.normalized()).norm());
    }
    for (std::size_t i = 0; i < m.axes.size(); ++i) {
      const bool is_finger = std::count(hand.fingers->axes.begin(), hand.fingers->axes.end(),
                                        static_cast<int>(m.axes[i])) > 0;
      const AxisExtremes reach = extremes(m.trajectory.axes[i]);
      if (is_finger) one.closed = std::max(one.closed, reach.highest - reach.lowest);
    }
    motions.push_back(one);
  });
  const auto is_over = [&] {
    const Snapshot& now = system.snapshot();
    return now.tasks.count(1) != 0 && (now.tasks.at(1).state == TaskState::succeeded ||
                                       now.tasks.at(1).state == TaskState::failed);
  };
  const auto goals = system.bus().advertise<TaskGoal>();
  system.bus().after(from_seconds(3.0), [&](TimePoint) {
    goals->publish({.id = 1, .kind = TaskKind::give, .object = "mug"});
  });
  system.network().run_until(is_over, TimePoint(from_seconds(90)));
  EXPECT_TRUE(is_over());
  EXPECT_EQ(system.snapshot().tasks.at(1).state, TaskState::succeeded);
  return motions;
}

const Commanded* find(const std::vector<Commanded>& motions, ActionPhase phase) {
  const auto found = std::find_if(motions.begin(), motions.end(),
                                  [phase](const Commanded& one) { return one.phase == phase; });
  return found == motions.end() ? nullptr : &*found;
}

TEST(ToolMotions, the_tool_moves_straight_to_the_grasp_up_and_off_the_object) {
  const std::vector<Commanded> motions = motions_of_a_give();
  for (const ActionPhase phase :
       {ActionPhase::reaching_object, ActionPhase::lift, ActionPhase::retreat}) {
    const Commanded* one = find(motions, phase);
    ASSERT_NE(one, nullptr) << text_of(phase);
    std::printf("%s: %.3f m, %.2f mm off the line, fingers by %.2f rad\n",
                std::string(text_of(phase)).c_str(), one->length, 1e3 * one->off_line, one->closed);
    EXPECT_GT(one->length, 0.03) << text_of(phase);
    EXPECT_LT(one->off_line, 5e-4) << text_of(phase);
    EXPECT_EQ(one->closed > 0.05, phase == ActionPhase::reaching_object)
        << "the hand closes in part on the way to the grasp";
  }
}

TEST(ToolMotions, the_hand_closes_at_the_object_alone_where_the_settings_say_so) {
  test::EditedSettings settings;
  settings.set("manipulation_planner.txtpb", "reach_closing", "0");
  const std::vector<Commanded> motions = motions_of_a_give(settings.folder());
  ASSERT_NE(find(motions, ActionPhase::reaching_object), nullptr);
  EXPECT_EQ(find(motions, ActionPhase::reaching_object)->closed, 0.0);
}

}  // namespace
}  // namespace handsel::tool_motions_test
