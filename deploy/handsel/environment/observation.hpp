// SPDX-License-Identifier: Apache-2.0
// What a policy observes of the running system, as JSON. Poses are 4 x 4 matrices T_world_x, row by
// row; lengths in m, angles in rad, world frame.
#pragma once

#include <nlohmann/json.hpp>

#include "common/bus/bus.hpp"
#include "common/config/schema/scenario.pb.h"
#include "common/messages/execution.hpp"
#include "common/messages/system.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_model.hpp"
#include "deploy/handsel/system/observer.hpp"

namespace handsel::environment {

/// Newest samples of the topics that a manipulation planner observes.
class View {
 public:
  /// Subscribes; must outlive the deliveries of the bus.
  explicit View(Bus& bus);
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  /// Returns whether robot, scene, people and the trajectory controller have been observed.
  bool complete() const;
  const Scene& scene() const { return scene_; }                    ///< newest one
  const HumanState& people() const { return people_; }             ///< newest one
  const ExecutionStatus& execution() const { return execution_; }  ///< newest one
  const ActiveTrajectory& active() const { return active_; }       ///< newest one
  /// Returns the object of the scene; throws command::LineError naming those there are.
  const SceneObject& object(const std::string& id) const;

 private:
  Scene scene_;
  HumanState people_;
  ExecutionStatus execution_;
  ActiveTrajectory active_;
  bool execution_known_{};
};

/// Returns the 16 elements of a pose, row by row.
nlohmann::json pose_json(const Pose& T);
/// Returns the elements of a vector.
nlohmann::json list_json(const Vector& values);

/// Returns what the system has perceived and what it does: time, robot, people, objects, boxes,
/// motion, task.
nlohmann::json observation(const View& view, const RobotModel& robot, const Snapshot& seen,
                           double time);

/// Returns what the simulator's oracle has seen (never given to the components of the system).
nlohmann::json oracle(const GroundTruth& ground_truth);

/// Returns the task of a scenario with its fields.
nlohmann::json task_json(const config::TaskDescription& task);

}  // namespace handsel::environment
