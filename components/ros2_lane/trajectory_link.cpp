// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/trajectory_link.hpp"

#include <cstdio>

namespace handsel::ros2_lane {

TrajectoryLink::TrajectoryLink(Bus& bus, RosTopics& topics,
                               const settings::Ros2LaneSettings& settings,
                               std::shared_ptr<const RobotModel> robot, std::uint64_t client)
    : bus_(bus),
      topics_(topics),
      settings_(settings),
      executor_(settings, std::move(robot), client) {}

void TrajectoryLink::open() {
  if (settings_.trajectory_in.empty()) return;
  query_out_ = bus_.advertise<StateQuery>();
  request_out_ = bus_.advertise<TrajectoryRequest>();
  if (!settings_.trajectory_result.empty())
    result_out_ = topics_.write<ros2::Text>(settings_.trajectory_result, Profile::goal);
  bus_.subscribe<ActionStatus>([this](const ActionStatus& m, const Receipt&) { executor_.on(m); });
  bus_.subscribe<ExecutionStatus>(
      [this](const ExecutionStatus& m, const Receipt&) { executor_.on(m); });
  bus_.subscribe<ActiveTrajectory>(
      [this](const ActiveTrajectory& m, const Receipt& r) { executor_.on(m, r.arrival); });
  bus_.subscribe<StateVerdict>([this](const StateVerdict& m, const Receipt&) { executor_.on(m); });
  bus_.subscribe<TrajectoryReply>(
      [this](const TrajectoryReply& m, const Receipt&) { executor_.on(m); });
  topics_.read<ros2::JointTrajectory>(settings_.trajectory_in, Profile::goal,
                                      [this](const ros2::JointTrajectory& m, const Receipt& r) {
                                        TrajectoryOutbox out;
                                        executor_.on(m, r.arrival, out);
                                        send(out);
                                      });
}

void TrajectoryLink::step(TimePoint now) {
  TrajectoryOutbox out;
  executor_.step(now, out);
  send(out);
}

std::string TrajectoryLink::trouble(TimePoint now) const {
  const std::string refusal = refusal_.current(now);
  return refusal.empty() ? refusal : "JointTrajectory " + refusal;
}

void TrajectoryLink::send(const TrajectoryOutbox& out) {
  if (out.query) query_out_->publish(*out.query);
  if (out.request) request_out_->publish(*out.request);
  if (out.command) {
    if (!command_out_) command_out_ = bus_.advertise<TrajectoryCommand>();
    command_out_->publish(*out.command);
  }
  if (out.command_done) command_out_.reset();
  for (const std::string& result : out.results) {
    std::fprintf(stderr, "JointTrajectory %s\n", result.c_str());
    refusal_.set(result == "done" ? "" : result, bus_.now());
    if (result_out_) result_out_->publish({result});
  }
}

}  // namespace handsel::ros2_lane
