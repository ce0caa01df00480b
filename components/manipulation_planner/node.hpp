// SPDX-License-Identifier: Apache-2.0
// The manipulation planner on a Bus.
#pragma once

#include <memory>

#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  template <class M>
  void feed();
  void step(TimePoint now);
  void publish_status(TimePoint now);

  Bus& bus_;
  settings::ManipulationPlannerSettings settings_;
  ManipulationPlanner core_;
  std::unique_ptr<Publisher<GraspRequest>> grasp_out_;
  std::unique_ptr<Publisher<RegraspRequest>> regrasp_out_;
  std::unique_ptr<Publisher<PathRequest>> path_out_;
  std::unique_ptr<Publisher<TrajectoryRequest>> trajectory_request_out_;
  std::unique_ptr<Publisher<TrajectoryCommand>> trajectory_out_;
  std::unique_ptr<Publisher<HandCommand>> hand_out_;
  std::unique_ptr<Publisher<ActionStatus>> status_out_;
  ActionStatus sent_;
  TimePoint status_sent_{};
};

}  // namespace handsel::manipulation_planner
