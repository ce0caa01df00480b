// SPDX-License-Identifier: Apache-2.0
// A motion asked for from ROS passes the same checks as every motion: its configurations are
// checked by the collision checker, its line is timed by the trajectory planner, the controller's
// guard decides while it runs. Or it is refused with the reason. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/settings/ros2_lane.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/ros2.hpp"
#include "common/messages/task.hpp"
#include "common/model/robot_model.hpp"
#include "components/ros2_lane/motion_request.hpp"
#include "components/ros2_lane/robot_activity.hpp"

namespace handsel::ros2_lane {

struct TrajectoryOutbox {
  std::optional<StateQuery> query;           ///< to the collision checker
  std::optional<TrajectoryRequest> request;  ///< to the trajectory planner
  std::optional<TrajectoryCommand> command;  ///< to the trajectory controller
  /// The controller has the command, or the motion was refused before: the writer is released, so
  /// that the manipulation planner may command again.
  bool command_done{};
  std::vector<std::string> results;  ///< one sentence each
};

/// The points of a JointTrajectory are the waypoints of a path, from where the arm is. Its times
/// count in so far as a slower motion is asked for; the trajectory planner limits the speed. A
/// first point at time 0 must be where the arm is. No points: the running one is stopped,
/// jerk-limited. Only while no task runs and the arm is at rest; a second one before the first has
/// ended is refused.
class TrajectoryExecutor {
 public:
  /// `client`: unique over the system and its restarts, grows.
  TrajectoryExecutor(const settings::Ros2LaneSettings& settings,
                     std::shared_ptr<const RobotModel> robot, std::uint64_t client);

  /// Begins the motion asked for, or refuses it with a sentence in `out`; without points stops the
  /// running one, or refuses one that has not begun.
  void on(const ros2::JointTrajectory&, TimePoint now, TrajectoryOutbox& out);
  /// Takes the newest status of the task's action; while it runs, motions are refused.
  void on(const ActionStatus& status) { activity_.on(status); }
  /// Takes the newest status of the controller: epoch, and whether the command runs.
  void on(const ExecutionStatus& status) { activity_.on(status); }
  /// Takes the robot's motion now; when older than 0.3 s, motions are refused.
  void on(const ActiveTrajectory& active, TimePoint arrival) { activity_.on(active, arrival); }
  /// Takes the checker's answer; one to another query is left out.
  void on(const StateVerdict&);
  /// Takes the planner's answer; one to another request is left out.
  void on(const TrajectoryReply&);
  /// Continues the motion; to be called often. Repeats a message without answer every 0.5 s, and
  /// refuses the motion after 5 s without answer to one message.
  void step(TimePoint now, TrajectoryOutbox& out);

 private:
  enum class Phase { idle, checking, timing, handing_over, running };
  /// Empty, or why it cannot be done.
  std::string prepare(const ros2::JointTrajectory&, TimePoint now);
  void refuse(const std::string& why, TrajectoryOutbox& out);
  void stop(TrajectoryOutbox& out);
  void ask(TrajectoryOutbox& out);
  void hand_over(TrajectoryOutbox& out);
  void follow(TrajectoryOutbox& out);

  settings::Ros2LaneSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  const Group& arm_;
  std::uint64_t client_, number_{0}, commands_;
  Phase phase_{Phase::idle};
  TimePoint begun_{}, asked_{};
  double min_duration_{0};  ///< Of the whole motion, as asked for [s].
  StateQuery query_;
  TrajectoryRequest request_;
  TrajectoryCommand command_;
  bool slowed_{false}, fresh_{false};
  std::optional<StateVerdict> verdict_;
  std::optional<TrajectoryReply> reply_;
  RobotActivity activity_;
};

}  // namespace handsel::ros2_lane
