// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/online_replanner.hpp"

#include "components/manipulation_planner/parts.hpp"
#include "tests/unit/manipulation_planner/manipulation_rig.hpp"

namespace handsel::manipulation_planner::online_replanner_test {
namespace {

constexpr std::uint64_t kCommand = 7;

/// A running motion of one axis by one radian, with emulated planners.
class OnlineReplannerTest : public testing::Test {
 protected:
  OnlineReplannerTest()
      : robot_(std::make_shared<RobotModel>(RobotModel::load(robot_description("jido")))),
        parts_(settings(), robot_, [](const std::string&) { return nullptr; }, 1000, {}) {
    const Vector start = RobotModel::part(robot_->rest_configuration(), arm());
    Vector goal = start;
    goal[0] += 1.0;
    running_ = {kCommand, 0, {start, goal}, Vector::Ones(1)};
    motion_.goals = {goal};
    whole_ = trajectory(running_.waypoints);
    running_.duration = whole_.duration();
    Scene scene;
    scene.robot_known = true;
    scene.robot_position = robot_->rest_configuration();
    parts_.now.on(scene);
    report(kCommand, MotionState::running);
    run_at(0.3);
  }
  static settings::ManipulationPlannerSettings settings() {
    auto settings = rig::settings();
    settings.replan_time = 0.2;
    return settings;
  }
  const Group& arm() const { return robot_->require_group("arm"); }
  Trajectory trajectory(const std::vector<Vector>& waypoints) const {
    KinematicLimits limits = robot_->comfort_limits();
    const std::vector<int>& axes = arm().axes;
    limits = {limits.velocity(axes), limits.acceleration(axes), limits.jerk(axes)};
    return smooth(waypoints, limits, {}, {},
                  std::vector<LimitZones>(waypoints.size() - 1, LimitZones{{1, 1}}))
        .trajectory;
  }
  void report(std::uint64_t command, MotionState state) {
    execution_.trajectory = command;
    execution_.motion = state;
    parts_.now.on(execution_);
  }
  /// Sets the progress of the controller along the motion [s] and its time scaling.
  void run_at(double time, double speed_factor = 1) {
    ActiveTrajectory active;
    active.trajectory = kCommand;
    active.time = time;
    active.rest = whole_;
    active.speed_factor = speed_factor;
    const MotionState3 state = whole_.at(time);
    active.position = RobotModel::with(robot_->rest_configuration(), arm(), state.position);
    active.velocity = Vector::Zero(robot_->dof());
    active.velocity(arm().axes) = state.velocity;
    parts_.now.on(active);
  }
  void start() {
    check_ = parts_.replanner.check(running_, motion_);
    check_.start();
  }
  void cycle() {
    now_ += from_seconds(0.02);
    parts_.now.set_time(now_);
    parts_.waiting.poll(now_);
    for (auto& job : parts_.outbox.jobs) {
      job();
      parts_.worker.job_done();
    }
    parts_.outbox.jobs.clear();
  }
  void answer_path(PathOutcome outcome, const std::vector<Vector>& path, bool solved = true) {
    PathReply reply;
    reply.id = parts_.outbox.path_requests.back().id;
    reply.solved = solved;
    reply.outcome = outcome;
    reply.path = path;
    reply.reason = "in collision";
    parts_.clients.path.on(reply);
    cycle();
  }
  void answer_trajectory() {
    const TrajectoryRequest& request = parts_.outbox.trajectory_requests.back();
    TrajectoryReply reply;
    reply.id = request.id;
    reply.solved = true;
    reply.trajectory = trajectory(request.nodes);
    reply.speeds = Vector::Ones(static_cast<Eigen::Index>(request.nodes.size()) - 1);
    parts_.clients.trajectory.on(reply);
    cycle();
  }

  std::shared_ptr<const RobotModel> robot_;
  Parts parts_;
  RunningMotion running_;
  MotionSpec motion_;
  Trajectory whole_;
  ExecutionStatus execution_;
  TimePoint now_{};
  Routine<Outcome> check_;
};

TEST_F(OnlineReplannerTest, asks_for_a_path_from_where_the_arm_will_be) {
  start();
  ASSERT_EQ(parts_.outbox.path_requests.size(), 1u);
  const PathRequest& request = parts_.outbox.path_requests.front();
  const Vector expected = whole_.at(0.3 + parts_.settings.replan_time).position;
  EXPECT_LT((RobotModel::part(request.start, arm()) - expected).norm(), 1e-9);
  EXPECT_EQ(request.running.size(), running_.waypoints.size());
  EXPECT_EQ(parts_.replanner.counts().checks, 1u);
}

TEST_F(OnlineReplannerTest, a_slowed_arm_does_less_meanwhile_but_may_be_faster_again) {
  const double least = parts_.settings.live_min_factor;
  for (const double factor : {0.5, 0.5 * least, 0.0}) {
    run_at(0.3, factor);
    start();
    const double counted = std::max(factor, least);
    const Vector expected = whole_.at(0.3 + counted * parts_.settings.replan_time).position;
    const Vector asked = RobotModel::part(parts_.outbox.path_requests.back().start, arm());
    EXPECT_LT((asked - expected).norm(), 1e-9) << factor;
  }
}

TEST_F(OnlineReplannerTest, leaves_a_motion_alone_that_is_not_its_own_or_nearly_over) {
  running_.command = kCommand + 1;
  start();
  ASSERT_TRUE(check_.done());
  EXPECT_FALSE(check_.result().good);
  running_.command = kCommand;
  run_at(whole_.duration() - parts_.settings.replan_time);
  start();
  ASSERT_TRUE(check_.done());
  EXPECT_FALSE(check_.result().good);
  EXPECT_TRUE(parts_.outbox.path_requests.empty());
  EXPECT_EQ(parts_.replanner.counts().checks, 0u);
}

TEST_F(OnlineReplannerTest, a_refused_path_changes_nothing) {
  start();
  answer_path(PathOutcome::replanned, {}, false);
  ASSERT_TRUE(check_.done());
  EXPECT_EQ(check_.result().reason, "in collision");
  EXPECT_EQ(parts_.replanner.counts().refused, 1u);
  EXPECT_TRUE(parts_.outbox.trajectories.empty());
  EXPECT_EQ(running_.command, kCommand);
}

TEST_F(OnlineReplannerTest, a_path_that_does_not_come_in_time_is_dropped) {
  start();
  for (int i = 0; i < 100 && !check_.done(); ++i) cycle();
  ASSERT_TRUE(check_.done());
  EXPECT_FALSE(check_.result().good);
  EXPECT_TRUE(parts_.outbox.trajectories.empty());
}

TEST_F(OnlineReplannerTest, an_unchanged_path_is_only_timed_for_comparison) {
  start();
  answer_path(PathOutcome::kept, running_.waypoints);
  EXPECT_EQ(parts_.replanner.counts().unchanged, 0u) << "before the comparison has come";
  ASSERT_EQ(parts_.outbox.trajectory_requests.size(), 1u);
  EXPECT_TRUE(parts_.outbox.trajectories.empty());
}

TEST_F(OnlineReplannerTest, switches_to_another_path_in_time_and_without_a_jump) {
  start();
  Vector other = running_.waypoints.back();
  other[1] -= 0.3;
  const Vector from = RobotModel::part(parts_.outbox.path_requests.front().start, arm());
  answer_path(PathOutcome::replanned, {from, other});
  answer_trajectory();
  cycle();
  ASSERT_EQ(parts_.outbox.trajectories.size(), 1u) << check_.result().reason;
  const TrajectoryCommand command = parts_.outbox.trajectories.front();
  const double switch_time = 0.3 + parts_.settings.replan_time;
  EXPECT_NEAR(command.switch_at, switch_time, 1e-9);
  const MotionState3 before = whole_.at(switch_time), after = command.trajectory.at(0);
  EXPECT_LT((before.position - after.position).norm() + (before.velocity - after.velocity).norm(),
            1e-9);
  report(command.id, MotionState::running);
  cycle();
  ASSERT_TRUE(check_.done());
  EXPECT_TRUE(check_.result().good) << check_.result().reason;
  EXPECT_EQ(running_.command, command.id);
  EXPECT_EQ(running_.waypoints.back(), other);
  EXPECT_EQ(parts_.replanner.counts().switched, 1u);
}

TEST_F(OnlineReplannerTest, a_path_that_is_ready_too_late_is_refused) {
  start();
  Vector other = running_.waypoints.back();
  other[1] -= 0.3;
  const Vector from = RobotModel::part(parts_.outbox.path_requests.front().start, arm());
  answer_path(PathOutcome::replanned, {from, other});
  run_at(0.3 + parts_.settings.replan_time);
  answer_trajectory();
  cycle();
  ASSERT_TRUE(check_.done());
  EXPECT_FALSE(check_.result().good);
  EXPECT_EQ(parts_.replanner.counts().refused, 1u);
  EXPECT_TRUE(parts_.outbox.trajectories.empty());
}

}  // namespace
}  // namespace handsel::manipulation_planner::online_replanner_test
