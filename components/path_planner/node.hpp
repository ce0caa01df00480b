// The path planner on a Bus.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/request_queue.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/collision/margins.hpp"
#include "common/cost/human_cost.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "components/path_planner/driving.hpp"
#include "components/path_planner/live_path.hpp"

namespace handsel::path_planner {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

  /// Returns how many requests to continue along a running path ended in each LiveOutcome.
  const std::array<std::uint64_t, 5>& live_outcomes() const { return live_outcomes_; }

 private:
  struct Timing {
    double check_time{}, longest_time{};
    Duration max_scene_age{};
  };
  void on_request(const PathRequest& request);
  void cancel(const RequestId& id);
  void start(const PathRequest& request);
  /// The robot on its platform.
  struct Mobile {
    Mobile(const RobotModel& mobile, const ObjectLibrary& objects, const CostSettings& weights)
        : world(mobile, objects), cost(mobile, weights), navigation(mobile, weights) {}
    CollisionWorld world;
    HumanCost cost;
    NavigationCost navigation;
  };
  /// What plans for a request: the robot where it stands, or on its platform.
  struct Seat {
    const RobotModel& robot;
    CollisionWorld& world;
    HumanCost& cost;
    NavigationCost* navigation{};  ///< null: it stands
  };
  Seat seat_for(const std::string& group);
  std::string complete(PathRequest& request) const;
  double make_head_room(const Seat& seat, const PathRequest& request, const Problem& problem, const HumanState& people) const;
  static std::vector<Vector> ends_of(const Problem& problem, const Vector& goal_so_far);
  Result from_nothing(const Seat& seat, const PathRequest& request, Problem& problem, const Pose& T_world_root, const Hooks& hooks);
  void stop_running(std::uint64_t client, std::uint64_t last);
  void refuse(const RequestId& id, const std::string& reason);
  void refuse_unheard(const RequestId& id, const std::string& reason);
  static PathReply refusal(const RequestId& id, const std::string& reason);
  std::string not_ready() const;

  Bus& bus_;
  std::shared_ptr<const RobotModel> robot_;
  Settings settings_;
  LiveSettings live_;
  Margins live_margins_;
  double roam_{};
  double head_room_{};
  std::array<std::uint64_t, 5> live_outcomes_{};
  Timing timing_;
  std::unique_ptr<Publisher<PathReply>> reply_out_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const HumanState> people_;
  CostLayers layers_;
  RequestQueue<PathReply> requests_{Newer::replaces};
  std::map<std::uint64_t, std::map<std::uint64_t, CancelToken>> running_;  // client, number

  // Used by jobs only, which run one after the other.
  CollisionWorld world_;
  HumanCost cost_;
  ObjectLibrary objects_;
  CostSettings weights_;
  std::optional<RobotModel> on_platform_;  // read only
  std::unique_ptr<Mobile> mobile_;         // from the first request that drives on
};

}  // namespace handsel::path_planner
