// SPDX-License-Identifier: Apache-2.0
// The executor of trajectories on a Bus.
#pragma once

#include <memory>
#include <string>

#include "components/ros2_lane/recent_report.hpp"
#include "components/ros2_lane/ros_topics.hpp"
#include "components/ros2_lane/trajectory_executor.hpp"

namespace handsel::ros2_lane {

/// Gives the executor what it reads, and publishes what it asks for.
class TrajectoryLink {
 public:
  /// `bus` and `topics` must outlive this; `client` as for TrajectoryExecutor.
  TrajectoryLink(Bus& bus, RosTopics& topics, const settings::Ros2LaneSettings& settings,
                 std::shared_ptr<const RobotModel> robot, std::uint64_t client);

  /// Subscribes and advertises; nothing where the settings name no topic of trajectories.
  void open();
  /// Continues the motion; to be called often.
  void step(TimePoint now);
  /// Returns the newest refusal, one sentence; empty: none lately.
  std::string trouble(TimePoint now) const;

 private:
  void send(const TrajectoryOutbox& out);

  Bus& bus_;
  RosTopics& topics_;
  settings::Ros2LaneSettings settings_;
  TrajectoryExecutor executor_;
  RecentReport refusal_;
  std::unique_ptr<Publisher<StateQuery>> query_out_;
  std::unique_ptr<Publisher<TrajectoryRequest>> request_out_;
  /// Present only while a command is handed over: then the manipulation planner's are refused.
  std::unique_ptr<Publisher<TrajectoryCommand>> command_out_;
  std::unique_ptr<Publisher<ros2::Text>> result_out_;
};

}  // namespace handsel::ros2_lane
