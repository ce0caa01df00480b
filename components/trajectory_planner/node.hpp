// SPDX-License-Identifier: Apache-2.0
// Binds the trajectory planner to a bus.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/base/advised_value.hpp"
#include "common/base/request_queue.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/messages/world.hpp"
#include "components/trajectory_planner/trajectory_planner.hpp"

namespace handsel::trajectory_planner {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  void on_request(const TrajectoryRequest& request);
  void start(const TrajectoryRequest& request);
  void answer(const TrajectoryReply& reply);
  void refuse(const RequestId& id, const std::string& reason);
  std::string not_ready() const;
  /// Returns whether the request moves the platform together with the tool.
  bool drives(const TrajectoryRequest& request) const;
  /// The robot on its platform.
  struct Mobile {
    Mobile(const RobotModel& mobile, const ObjectLibrary& objects, const CostSettings& weights)
        : world(mobile, objects), cost(mobile, weights) {}
    CollisionWorld world;
    HumanCost cost;
  };

  Bus& bus_;
  std::shared_ptr<const RobotModel> robot_;
  std::optional<RobotModel> on_platform_;
  ObjectLibrary objects_;
  CostSettings weights_;
  Settings settings_;
  Duration max_scene_age_{}, check_time_{};
  std::unique_ptr<Publisher<TrajectoryReply>> reply_out_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const HumanState> people_;
  CostLayers layers_;
  AdvisedValue<double> cost_gain_;
  RequestQueue<TrajectoryReply> requests_{OlderRequests::keep};

  // Used by jobs only, which run one after the other.
  CollisionWorld world_;
  HumanCost cost_;
  std::unique_ptr<Mobile> mobile_;
};

}  // namespace handsel::trajectory_planner
