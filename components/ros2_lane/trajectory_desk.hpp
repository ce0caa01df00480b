// A motion asked for from ROS goes the way every motion goes: its configurations are judged by the collision checker, its line is timed by
// the trajectory planner, the controller's guard decides while it runs. Or it is refused with the reason. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/schema/ros2_lane.pb.h"
#include "common/messages/execution.hpp"
#include "common/messages/ros2.hpp"
#include "common/messages/task.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::ros2_lane {

struct TrajectoryOutbox {
  std::optional<StateQuery> query;
  std::optional<TrajectoryRequest> request;
  std::optional<TrajectoryCommand> command;
  bool command_done{};               ///< the controller has taken or refused it: others may command again
  std::vector<std::string> results;  ///< one sentence each
};

/// The points of a JointTrajectory are the nodes of a path, from where the arm is. Its times count in so far as a slower motion is asked
/// for; how fast it may be is ours to say. A first point at time 0 must be where the arm is. No points: the running one is stopped softly.
/// Only while no task runs and the arm is at rest; a second one before the first has ended is refused.
class TrajectoryDesk {
 public:
  /// `client`: unique over the system and its restarts, grows.
  TrajectoryDesk(const config::Ros2LaneSettings& settings, std::shared_ptr<const RobotModel> robot, std::uint64_t client);

  void on(const ros2::JointTrajectory&, TimePoint now, TrajectoryOutbox& out);
  void on(const ActionStatus& status) { action_ = status; }
  void on(const ExecutionStatus& status) { execution_ = status; }
  void on(const ActiveTrajectory&, TimePoint arrival);
  void on(const StateVerdict&);
  void on(const TrajectoryReply&);
  /// To be called often; repeats what is not answered.
  void step(TimePoint now, TrajectoryOutbox& out);

 private:
  enum class Phase { idle, judging, timing, handing_over, running };
  /// Empty, or why it cannot be done.
  std::string prepare(const ros2::JointTrajectory&, TimePoint now);
  std::string why_not_now(TimePoint now) const;
  void refuse(const std::string& why, TrajectoryOutbox& out);
  void stop(TrajectoryOutbox& out);
  void ask(TrajectoryOutbox& out);
  void hand_over(TrajectoryOutbox& out);
  void follow(TrajectoryOutbox& out);

  config::Ros2LaneSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  const Group& arm_;
  std::uint64_t client_, number_{0}, commands_;
  Phase phase_{Phase::idle};
  TimePoint begun_{}, asked_{};
  double wanted_{0};  // [s] the whole motion shall take at least
  StateQuery query_;
  TrajectoryRequest request_;
  TrajectoryCommand command_;
  bool slowed_{false}, fresh_{false};
  std::optional<StateVerdict> verdict_;
  std::optional<TrajectoryReply> reply_;
  std::optional<ActionStatus> action_;
  std::optional<ExecutionStatus> execution_;
  std::optional<ActiveTrajectory> active_;
  TimePoint active_at_{};
};

}  // namespace handsel::ros2_lane
