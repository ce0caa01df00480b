// SPDX-License-Identifier: Apache-2.0
// What the manipulation planner sends: the parts fill it, the node empties it after each step.
#pragma once

#include <functional>
#include <iterator>
#include <vector>

#include "common/messages/execution.hpp"
#include "common/messages/planning.hpp"

namespace handsel::manipulation_planner {

/// What the core wants sent; the node empties it after each step.
struct Outbox {
  std::vector<GraspRequest> grasp_requests;      ///< to the grasp planner
  std::vector<RegraspRequest> regrasp_requests;  ///< to the grasp planner, for two hands
  std::vector<PathRequest> path_requests;        ///< to the path planner; also those that cancel
  std::vector<TrajectoryRequest> trajectory_requests;  ///< to the trajectory planner
  std::vector<TrajectoryCommand> trajectories;         ///< to the trajectory controller
  std::vector<HandCommand> hand_commands;              ///< to the controller of the hand
  std::vector<std::function<void()>> jobs;             ///< long work; call job_done() after each

  /// Moves everything to the end of another outbox, in order.
  void move_to(Outbox& other) {
    const auto append = [](auto& from, auto& to) {
      to.insert(to.end(), std::make_move_iterator(from.begin()),
                std::make_move_iterator(from.end()));
      from.clear();
    };
    append(grasp_requests, other.grasp_requests);
    append(regrasp_requests, other.regrasp_requests);
    append(path_requests, other.path_requests);
    append(trajectory_requests, other.trajectory_requests);
    append(trajectories, other.trajectories);
    append(hand_commands, other.hand_commands);
    append(jobs, other.jobs);
  }
};

}  // namespace handsel::manipulation_planner
