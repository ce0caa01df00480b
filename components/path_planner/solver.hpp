// Plans for the requests of the node: picks the models, sets up the world, and chooses between a
// path that is continued, one in Cartesian space and one between configurations. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/collision/margins.hpp"
#include "common/cost/human_cost.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "components/path_planner/driving.hpp"
#include "components/path_planner/live_path.hpp"

namespace handsel::path_planner {

struct SolverSettings {
  Settings search;                   ///< Of every search.
  ReplanSettings live;               ///< Of requests to continue along a running path.
  Margins replan_margins;            ///< Clearance that a running path keeps to obstacles [m].
  double roam{};                     ///< How far the platform may drive around start and goals [m].
  FurnitureRoom furniture;           ///< Level clearance of paths of the platform from furniture.
  double driven_room_fraction{0.5};  ///< Fraction of that which a platform keeps on its path.
  double head_room{};  ///< Clearance to heads that paths between configurations keep [m].
};

/// One request with what was known when it came.
struct PlanningTask {
  PathRequest request;                       ///< Complete, without contradiction.
  Problem problem;                           ///< As problem_of() gives it, with its budget.
  Pose T_world_root{Pose::Identity()};       ///< Root of the robot that is planned for.
  std::shared_ptr<const Scene> scene;        ///< Never null.
  std::shared_ptr<const HumanState> people;  ///< Never null.
  LayersNow layers;                          ///< Cost layers.
  double cost_gain{1.0};                     ///< Factor of what people cost, of attention.
  ReplanOutcome outcome{};                   ///< Result: of a request to continue.
  Result result;                             ///< Result.
};

/// The robot where it stands, and on its platform where a description has one.
class Solver {
 public:
  /// `mobile`: the robot on its platform, or nothing.
  Solver(std::shared_ptr<const RobotModel> robot, std::optional<RobotModel> mobile,
         const ObjectLibrary& objects, const CostSettings& weights, const SolverSettings& settings);

  /// Returns whether the request is for the robot on its platform.
  bool drives_platform(const PathRequest& request) const;
  /// Sets the start of a request that drives where it has none, and returns why the request makes
  /// no sense, or an empty text. Safe beside solve().
  std::string complete(PathRequest& request, const Pose& T_world_base) const;
  /// Returns a task without budget; `scene` must not be null. Safe beside solve().
  PlanningTask make_task(const PathRequest& request, std::shared_ptr<const Scene> scene) const;
  /// Fills the results of the task. One call at a time.
  void solve(PlanningTask& task, const Hooks& hooks);

 private:
  /// The robot on its platform.
  struct Mobile {
    Mobile(const RobotModel& mobile, const ObjectLibrary& objects, const CostSettings& weights)
        : world(mobile, objects), cost(mobile, weights), navigation(mobile, weights) {}
    CollisionWorld world;
    HumanCost cost;
    NavigationCost navigation;
  };
  /// What plans for a request: the robot where it stands, or on its platform.
  struct Selected {
    PlanningModels models;
    NavigationCost* navigation{};  ///< Null: it stands.
  };
  void prepare_mobile();
  Selected select(const PathRequest& request);
  void set_world(const Selected& selected, PlanningTask& task);
  void solve_once(const Selected& selected, PlanningTask& task, const Hooks& hooks);
  bool keep_clearance(const Selected& selected, const PlanningTask& task) const;
  double keep_head_clearance(const Selected& selected, const PlanningTask& task) const;
  Result plan_new(const Selected& selected, PlanningTask& task, const Hooks& hooks);
  Result plan_to_poses(const Selected& selected, const std::vector<PoseGoal>& poses,
                       PlanningTask& task, const Hooks& hooks);

  std::shared_ptr<const RobotModel> robot_;
  std::optional<RobotModel> on_platform_;
  ObjectLibrary objects_;
  CostSettings weights_;
  SolverSettings settings_;
  CollisionWorld world_;
  HumanCost cost_;
  std::unique_ptr<Mobile>
      mobile_;  ///< From the beginning if the robot drives, else from its first request.
};

}  // namespace handsel::path_planner
