// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/joint_input.hpp"

namespace handsel::ros2_lane {

JointInput::JointInput(const RobotModel& robot, const settings::Ros2LaneSettings& settings)
    : settings_(settings), joints_(robot, settings.joint_age) {}

std::optional<RobotState> JointInput::on(const ros2::JointState& message, TimePoint arrival,
                                         const TfTree& tree) {
  joints_.on(message, arrival);
  received_ = true;
  auto state = joints_.state(arrival);
  if (!state) return std::nullopt;
  state->T_world_base = T_world_base_;
  if (!settings_.base_frame.empty()) {
    const auto place = tree.find(settings_.base_frame, settings_.world_frame);
    base_known_ = place && arrival - place->arrival <= from_seconds(settings_.people_age);
    if (!base_known_) return std::nullopt;
    state->T_world_base = place->T_root_frame;
  }
  return state;
}

std::string JointInput::trouble(TimePoint now) const {
  if (!received_) return {};
  if (const std::string missing = joints_.missing(now); !missing.empty())
    return "JointState does not tell of " + missing;
  if (!base_known_)
    return "TF has no current transform from frame " + settings_.base_frame + " to " +
           settings_.world_frame;
  return {};
}

}  // namespace handsel::ros2_lane
