// SPDX-License-Identifier: Apache-2.0
// Plans the requests of the node: selects models, sets up the world, and selects between online
// replanning, planning in Cartesian space and planning between configurations. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/collision/margins.hpp"
#include "common/cost/human_cost.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "components/path_planner/cartesian.hpp"
#include "components/path_planner/driving.hpp"
#include "components/path_planner/live_path.hpp"

namespace handsel::path_planner {

struct SolverSettings {
  Settings search;              ///< Settings of every search.
  ReplanSettings live;          ///< Settings of online replanning.
  CartesianSettings cartesian;  ///< Settings of searches in Cartesian space.
  Margins replan_margins;       ///< Clearance of a running path to obstacles [m].
  double roam{};                ///< Max distance of the platform's path around start and goals [m].
  FurnitureRoom furniture;      ///< Horizontal clearance of the platform from furniture.
  double driven_room_fraction{0.5};  ///< Fraction of this clearance in online replanning.
  double head_room{};                ///< Clearance of paths between configurations to heads [m].
  PlatformSampling sampling;         ///< Platform poses tried for a pose of the tip.
};

/// One request with the state of the world at its arrival.
struct PlanningTask {
  PathRequest request;                       ///< Complete and valid.
  Problem problem;                           ///< Result of problem_of(), with a budget.
  Pose T_world_root{Pose::Identity()};       ///< Root of the planned robot in the world.
  std::shared_ptr<const Scene> scene;        ///< Never null.
  std::shared_ptr<const HumanState> people;  ///< Never null.
  std::vector<OtherRobot> digits;            ///< Digits of people who hold objects, world.
  LayersNow layers;                          ///< Cost layers.
  double cost_gain{1.0};                     ///< Factor of the human-aware cost, by attention.
  ReplanOutcome outcome{};                   ///< Result of online replanning.
  Result result;                             ///< Result of planning.
};

/// Plans for the robot on a fixed base, and on its platform if the description has one.
class Solver {
 public:
  /// `mobile`: the robot on its platform; nullopt: no platform.
  Solver(std::shared_ptr<const RobotModel> robot, std::optional<RobotModel> mobile,
         const ObjectLibrary& objects, const CostSettings& weights, const SolverSettings& settings);

  /// Returns whether the request plans axes of the platform.
  bool drives_platform(const PathRequest& request) const;
  /// Adds the platform's pose to the start of a request that lacks it. Returns why the request is
  /// invalid, one sentence; empty: valid. May run in parallel to solve().
  std::string complete(PathRequest& request, const Pose& T_world_base) const;
  /// Returns a task without budget; `scene` must not be null. May run in parallel to solve().
  PlanningTask make_task(const PathRequest& request, std::shared_ptr<const Scene> scene) const;
  /// Writes the results of the task. One call at a time.
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
  /// Models for a request: the robot on a fixed base, or on its platform.
  struct Selected {
    PlanningModels models;
    NavigationCost* navigation{};  ///< Null: fixed base.
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
  /// Exists from the start for a mobile robot, else from the first request for the platform.
  std::unique_ptr<Mobile> mobile_;
};

}  // namespace handsel::path_planner
