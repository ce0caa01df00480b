// SPDX-License-Identifier: Apache-2.0
// The link to ROS 2 on a Bus: topics of ROS beside those of the system.
#pragma once

#include <memory>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/node_context.hpp"
#include "common/bus/process.hpp"
#include "components/ros2_lane/frame_conflicts.hpp"
#include "components/ros2_lane/joint_input.hpp"
#include "components/ros2_lane/observers.hpp"
#include "components/ros2_lane/robot_output.hpp"
#include "components/ros2_lane/ros_topics.hpp"
#include "components/ros2_lane/sample_plan.hpp"
#include "components/ros2_lane/trajectory_link.hpp"

namespace handsel::ros2_lane {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

  /// What is wrong with what comes from ROS, as the health shows it; empty: nothing.
  std::string trouble() const;

 private:
  void open_people_and_objects();
  void open_robot(const NodeContext& context);
  void open_trajectories();
  void open_outputs();
  void on(const ros2::Transforms&, TimePoint arrival, bool is_static);

  Bus& bus_;
  settings::Ros2LaneSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  RosTopics topics_;
  TfTree tree_;
  PeopleObserver people_;
  ObjectsObserver objects_;
  SamplePlan samples_;
  JointInput joints_;
  FrameConflicts conflicts_;
  RobotOutput output_;
  TrajectoryLink trajectories_;
  std::unique_ptr<Publisher<HumanObservation>> human_out_;
  std::unique_ptr<Publisher<ObjectObservation>> object_out_;
  std::unique_ptr<Publisher<RobotState>> robot_out_;
  std::unique_ptr<Publisher<ros2::JointState>> joints_out_;
  std::unique_ptr<Publisher<ros2::Transforms>> frames_out_;
};

}  // namespace handsel::ros2_lane
