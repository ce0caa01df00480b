// The path planner on a Bus.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "components/path_planner/live_path.hpp"
#include "components/path_planner/request_desk.hpp"

namespace handsel::path_planner {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

  /// How requests to go on along a running path ended, by LiveOutcome.
  const std::array<std::uint64_t, 5>& live_outcomes() const { return live_outcomes_; }

 private:
  struct Timing {
    double check_time{}, longest_time{};
    Duration max_scene_age{};
  };
  void on_request(const PathRequest& request);
  void cancel(const RequestId& id);
  void start(const PathRequest& request);
  Result from_nothing(const PathRequest& request, Problem& problem, const Pose& T_world_base, const Hooks& hooks);
  void refuse(const RequestId& id, const std::string& reason);
  std::string not_ready() const;

  Bus& bus_;
  std::shared_ptr<const RobotModel> robot_;
  Settings settings_;
  LiveSettings live_;
  double live_margin_{};
  std::array<std::uint64_t, 5> live_outcomes_{};
  Timing timing_;
  std::unique_ptr<Publisher<PathReply>> reply_out_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const HumanState> people_;
  CostLayers layers_;
  RequestDesk desk_;
  std::map<std::uint64_t, std::map<std::uint64_t, CancelToken>> running_;  // client, number

  // Used by jobs only, which run one after the other.
  CollisionWorld world_;
  HumanCost cost_;
};

}  // namespace handsel::path_planner
