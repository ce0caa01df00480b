// The link to ROS 2 on a Bus: topics of ROS beside those of the system.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/node_context.hpp"
#include "common/bus/process.hpp"
#include "common/messages/world.hpp"
#include "components/ros2_lane/observers.hpp"
#include "components/ros2_lane/robot_joints.hpp"
#include "components/ros2_lane/trajectory_desk.hpp"

namespace handsel::ros2_lane {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

  /// What is wrong with what comes from ROS, as the health shows it; empty: nothing.
  std::string trouble() const;

 private:
  template <class M>
  const MessageType& type(const std::string& name, Profile profile);
  template <class M>
  void read(const std::string& name, Profile profile, std::function<void(const M&, const Receipt&)> on_sample);
  template <class M>
  std::unique_ptr<Publisher<M>> write(const std::string& name, Profile profile);

  void open_people_and_objects();
  void open_robot(const NodeContext& context);
  void open_trajectories();
  void open_outputs();
  void on(const ros2::Transforms&, TimePoint arrival, bool is_static);
  void gather(TimePoint now);
  void send(const TrajectoryOutbox&);
  void tell_frames();

  Bus& bus_;
  settings::Ros2LaneSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  std::vector<std::unique_ptr<MessageType>> types_;
  TfTree tree_;
  PeopleObserver people_;
  ObjectsObserver objects_;
  JointGatherer joints_;
  TrajectoryDesk desk_;
  Pose T_world_base_{Pose::Identity()};
  bool robot_heard_{false};
  bool base_known_{true};  // false: the base has no transform, or an old one
  /// Of the robot's links, when TF gets them: nobody else may send them.
  std::map<std::string, std::string> own_parents_;
  std::string clash_;  ///< of a frame from outside with one of them
  TimePoint clash_at_{};
  std::string refused_;
  TimePoint refused_at_{};
  std::optional<RobotState> state_;
  std::optional<Scene> scene_;
  std::unique_ptr<Publisher<HumanObservation>> human_out_;
  std::unique_ptr<Publisher<ObjectObservation>> object_out_;
  std::unique_ptr<Publisher<RobotState>> robot_out_;
  std::unique_ptr<Publisher<StateQuery>> query_out_;
  std::unique_ptr<Publisher<TrajectoryRequest>> request_out_;
  /// There only while a command is handed over: then the manipulation planner's are refused.
  std::unique_ptr<Publisher<TrajectoryCommand>> command_out_;
  std::unique_ptr<Publisher<ros2::JointState>> joints_out_;
  std::unique_ptr<Publisher<ros2::Transforms>> frames_out_;
  std::unique_ptr<Publisher<ros2::Text>> result_out_;
};

}  // namespace handsel::ros2_lane
