// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/robot_output.hpp"

#include "components/ros2_lane/robot_joints.hpp"

namespace handsel::ros2_lane {

void RobotOutput::on(const RobotState& state) {
  if (state.robot == robot_.name() && state.position.size() == robot_.dof()) state_ = state;
}

std::optional<ros2::JointState> RobotOutput::joints() const {
  if (!state_) return std::nullopt;
  return joint_state_of(robot_, *state_);
}

ros2::Transforms RobotOutput::frames() const {
  ros2::Transforms out;
  if (state_) add_links(robot_, *state_, settings_.world_frame, out.transforms);
  if (scene_)
    for (const SceneObject& object : scene_->objects)
      out.transforms.push_back({scene_->stamp, settings_.world_frame,
                                settings_.object_prefix + object.id, object.T_world_object});
  return out;
}

std::map<std::string, std::string> RobotOutput::link_parents() const {
  std::map<std::string, std::string> out;
  const std::vector<Link>& links = robot_.links();
  for (std::size_t i = 1; i < links.size(); ++i) {
    const Joint& joint = robot_.joints()[static_cast<std::size_t>(links[i].parent_joint)];
    out[links[i].name] = links[static_cast<std::size_t>(joint.parent)].name;
  }
  return out;
}

}  // namespace handsel::ros2_lane
