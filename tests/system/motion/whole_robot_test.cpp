// SPDX-License-Identifier: Apache-2.0
// Motions of the whole robot: tool, elbow, hand and head in one trajectory (chapter section 4.6.1),
// planned by the trajectory planner and executed by the controller of the running system in
// lock-step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "common/collision/collision_world.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/planning.hpp"
#include "common/model/manipulator.hpp"
#include "common/trajectory/limits_check.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/tool_motions.hpp"

namespace handsel::whole_robot_test {
namespace {

int motions_wanted() {
  const char* text = std::getenv("HANDSEL_WHOLE_MOTIONS");
  return text != nullptr ? std::atoi(text) : 4;
}

std::string empty_room(const std::string& robot) {
  return "name: \"empty_room\"\nrobot: \"" + robot + R"("
people { id: "anna" x: 6 y: 4 yaw: 3.1416 stature: 1.72 behaviour: STILL }
human_sensors { source: "kinect" rate: 30 latency: 0.04 noise: 0 }
object_sensors { source: "object_tracker" rate: 30 latency: 0.04 noise: 0 }
)";
}

/// Max deviations of the set-points from the plan.
struct Deviation {
  double position{};  ///< of the tool from the planned trajectory [m]
  double angle{};     ///< of the tool [rad]
  double joint{};     ///< of any axis but those of the head [rad, m]
  double limits{};    ///< largest ratio of velocity, acceleration or jerk to the guard limits
};

/// The running system, and a client that plans motions of the tool and has them executed.
class WholeRobot {
 public:
  explicit WholeRobot(const std::string& robot)
      : context_(system_context(folder_.write("room.txtpb", empty_room(robot)).string(), "", 1)),
        robot_(*context_.robot),
        hand_(hands_of(robot_).front()),
        system_(context_),
        requests_(system_.bus().advertise<TrajectoryRequest>()),
        commands_(system_.network().add("ros2_lane").advertise<TrajectoryCommand>()) {
    system_.bus().subscribe<TrajectoryReply>(
        [this](const TrajectoryReply& m, const Receipt&) { reply_ = m; });
    system_.bus().subscribe<ExecutionStatus>(
        [this](const ExecutionStatus& m, const Receipt&) { status_ = m; });
    system_.bus().subscribe<Scene>([this](const Scene& m, const Receipt&) { scene_ = m; });
    system_.bus().subscribe<Go>([this](const Go& m, const Receipt&) { go_ = m; });
    system_.bus().subscribe<JointCommand>(
        [this](const JointCommand& m, const Receipt&) { on_set_point(m); });
    also_ = hand_.fingers->axes;
    if (const Group* head = robot_.group("head"))
      also_.insert(also_.end(), head->axes.begin(), head->axes.end());
    const auto ready = [this] { return not_ready(system_.snapshot(), false).empty(); };
    system_.network().run_until(ready, system_.now() + from_seconds(20));
    system_.network().run_for(from_seconds(1));
    EXPECT_TRUE(go_.allowed) << "the system permits motion";
  }

  const std::vector<int>& also() const { return also_; }
  const RobotModel& robot() const { return robot_; }
  const Vector& set_point() const { return set_point_; }

  /// Plans a random motion from where the robot is; false: it does not exist.
  bool plan(std::mt19937& random) {
    CollisionWorld world(robot_, {});
    const auto motion = test::tool_motion(robot_, *hand_.arm, also_, set_point_, world, random);
    if (motion.nodes.empty()) return false;
    TrajectoryRequest request;
    request.id = {77, ++number_};
    request.group = hand_.arm->name;
    request.start = set_point_;
    request.also.assign(also_.begin(), also_.end());
    for (const auto& node : motion.nodes)
      request.poses.push_back({scene_.T_world_base * node.T_root_tool, node.elbow.has_value(),
                               node.elbow.value_or(0.0), node.also});
    reply_ = {};
    EXPECT_TRUE(requests_->publish(request));
    system_.network().run_until([&] { return reply_.id.number == number_; },
                                system_.now() + from_seconds(20));
    return reply_.solved;
  }

  /// Executes the plan and compares each set-point with the plan.
  Deviation execute() {
    TrajectoryCommand command;
    command.id = 1000 + number_;
    command.epoch = go_.epoch;
    command.robot = robot_.name();
    command.axes = reply_.axes;
    command.trajectory = reply_.trajectory;
    deviation_ = {};
    time_ = 0.0;
    EXPECT_TRUE(commands_->publish(command));
    const auto has_ended = [&] {
      return status_.trajectory == command.id && status_.motion != MotionState::running;
    };
    watches_ = true;
    system_.network().run_until(has_ended, system_.now() + from_seconds(60));
    watches_ = false;
    EXPECT_EQ(status_.trajectory, command.id);
    EXPECT_EQ(status_.motion, MotionState::finished) << status_.reason;
    const MotionState3 end = command.trajectory.at(command.trajectory.duration());
    for (std::size_t i = 0; i < command.axes.size(); ++i)
      EXPECT_NEAR(set_point_[command.axes[i]], end.position[static_cast<Eigen::Index>(i)], 1e-6)
          << robot_.axes()[command.axes[i]].name;
    system_.network().run_for(from_seconds(0.1));
    return deviation_;
  }
  const TrajectoryReply& reply() const { return reply_; }

 private:
  bool is_of_head(std::uint32_t axis) const {
    const Group* head = robot_.group("head");
    return head != nullptr && std::find(head->axes.begin(), head->axes.end(),
                                        static_cast<int>(axis)) != head->axes.end();
  }
  void on_set_point(const JointCommand& m) {
    constexpr int kEvery = 7;  // cycles per comparison, which takes longer than a cycle
    set_point_ = m.position;
    if (!watches_ || status_.trajectory != 1000 + number_ || ++seen_ % kEvery != 0) return;
    compare(m);
  }

  /// The set-points run along the plan at their own pace: each is compared with the nearest place
  /// on it. A head that turned before the motion reaches the plan later than the arm and is not
  /// compared until the end.
  void compare(const JointCommand& m) {
    constexpr double kStep = 2e-4, kWindow = 0.012;  // [s]
    const auto off = [&](double time) {
      const Vector planned = reply_.trajectory.at(time).position;
      double most = 0.0;
      for (std::size_t i = 0; i < reply_.axes.size(); ++i)
        if (!is_of_head(reply_.axes[i]))
          most = std::max(
              most, std::abs(planned[static_cast<Eigen::Index>(i)] - m.position[reply_.axes[i]]));
      return most;
    };
    double nearest = time_;
    for (double t = time_; t <= time_ + kWindow; t += kStep)
      if (off(t) < off(nearest)) nearest = t;
    time_ = nearest;
    Vector planned = m.position;
    const Vector part = reply_.trajectory.at(nearest).position;
    for (std::size_t i = 0; i < reply_.axes.size(); ++i)
      planned[reply_.axes[i]] = part[static_cast<Eigen::Index>(i)];
    const Pose want = robot_.link_pose(planned, hand_.palm),
               is = robot_.link_pose(m.position, hand_.palm);
    const KinematicLimits& guard = robot_.guard_limits();
    deviation_.position =
        std::max(deviation_.position, (want.translation() - is.translation()).norm());
    deviation_.angle = std::max(deviation_.angle,
                                Eigen::AngleAxisd(want.linear().transpose() * is.linear()).angle());
    deviation_.joint = std::max(deviation_.joint, off(nearest));
    for (Eigen::Index i = 0; i < m.position.size(); ++i)
      deviation_.limits = std::max({deviation_.limits, std::abs(m.velocity[i]) / guard.velocity[i],
                                    std::abs(m.acceleration[i]) / guard.acceleration[i]});
  }

  test::TemporaryFolder folder_;
  NodeContext context_;
  const RobotModel& robot_;
  Manipulator hand_;
  LockstepSystem system_;
  std::unique_ptr<Publisher<TrajectoryRequest>> requests_;
  std::unique_ptr<Publisher<TrajectoryCommand>> commands_;
  std::vector<int> also_;
  TrajectoryReply reply_;
  ExecutionStatus status_;
  Scene scene_;
  Go go_;
  Vector set_point_;
  Deviation deviation_;
  double time_{};  // of the last compared set-point on the plan [s]
  std::uint64_t number_{};
  long seen_{};
  bool watches_{};
};

class WholeRobotMotions : public testing::TestWithParam<const char*> {};

TEST_P(WholeRobotMotions, are_executed_as_planned_with_hand_and_head) {
  WholeRobot whole(GetParam());
  std::mt19937 random(20261);
  int done = 0;
  Deviation most;
  double moved_also = 0.0;
  for (int tries = 0; done < motions_wanted() && tries < 20 * motions_wanted(); ++tries) {
    if (!whole.plan(random)) continue;
    const TrajectoryReply& reply = whole.reply();
    for (const int axis : whole.also()) {
      const auto found =
          std::find(reply.axes.begin(), reply.axes.end(), static_cast<std::uint32_t>(axis));
      ASSERT_NE(found, reply.axes.end())
          << whole.robot().axes()[static_cast<std::size_t>(axis)].name;
    }
    const Vector before = whole.set_point();
    const Deviation one = whole.execute();
    for (const int axis : whole.also())
      moved_also = std::max(moved_also, std::abs(whole.set_point()[axis] - before[axis]));
    most = {std::max(most.position, one.position), std::max(most.angle, one.angle),
            std::max(most.joint, one.joint), std::max(most.limits, one.limits)};
    ++done;
    if (HasFailure()) break;
  }
  std::printf(
      "%s: %d motions with %zu axes beside the arm, which moved by up to %.2f rad; tool off by "
      "at most %.3f mm and %.4f degrees, joints %.2e rad; %.3f of the guard limits\n",
      GetParam(), done, whole.also().size(), moved_also, 1e3 * most.position,
      most.angle * 180 / M_PI, most.joint, most.limits);
  EXPECT_EQ(done, motions_wanted());
  EXPECT_GT(moved_also, 0.02);
  EXPECT_LT(most.joint, 1e-3);
  EXPECT_LT(most.position, 1e-3);
  EXPECT_LT(most.angle, 0.1 * M_PI / 180);
  EXPECT_LE(most.limits, 1 + 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Robots, WholeRobotMotions, testing::Values("jido", "duo", "iiwa14"),
                         [](const auto& robot) { return std::string(robot.param); });

}  // namespace
}  // namespace handsel::whole_robot_test
