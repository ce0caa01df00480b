// SPDX-License-Identifier: Apache-2.0
// Binds the path planner to a bus.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/advised_value.hpp"
#include "common/base/request_queue.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/cost/cost_layers.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "components/path_planner/held_digits.hpp"
#include "components/path_planner/solver.hpp"

namespace handsel::settings {
struct PathPlannerSettings;
}

namespace handsel::path_planner {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

  /// Returns the number of requests for online replanning by ReplanOutcome.
  const std::array<std::uint64_t, 5>& replan_outcomes() const { return replan_outcomes_; }

 private:
  Node(Bus& bus, const NodeContext& context, const settings::PathPlannerSettings& file);
  struct Timing {
    double check_time{}, max_time{};
    Duration max_scene_age{};
  };
  void on_request(const PathRequest& request);
  /// Answers a cancelled request at once; its planning ends with the next check.
  void cancel(const RequestId& id);
  void start(const PathRequest& request);
  void answer(const PlanningTask& task);
  /// Cancels planning for the requests of a client up to this number, as cancel() does.
  void stop_running(std::uint64_t client, std::uint64_t last);
  void refuse(const RequestId& id, const std::string& reason);
  /// Refuses a request without storing the answer, so that the same request can be repeated.
  void refuse_once(const RequestId& id, const std::string& reason);
  std::string not_ready() const;

  Bus& bus_;
  Timing timing_;
  std::array<std::uint64_t, 5> replan_outcomes_{};
  std::unique_ptr<Publisher<PathReply>> reply_out_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const HumanState> people_;
  HeldDigits digits_;
  CostLayers layers_;
  AdvisedValue<double> cost_gain_;
  RequestQueue<PathReply> requests_{OlderRequests::supersede};
  /// By client and number.
  std::map<std::uint64_t, std::map<std::uint64_t, CancelToken>> running_;
  Solver solver_;  ///< Used only in jobs, which run one after the other.
};

}  // namespace handsel::path_planner
