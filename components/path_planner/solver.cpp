// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/solver.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "components/path_planner/head_room.hpp"
#include "components/path_planner/request.hpp"

namespace handsel::path_planner {
namespace {

/// Returns start and first goal, all axes; only the start if goals are not configurations.
std::vector<Vector> first_ends_of(const Problem& problem) {
  std::vector<Vector> ends = {problem.start};
  if (problem.goals.empty()) return ends;
  Vector goal = problem.start;
  goal(problem.axes) = problem.goals.front();
  ends.push_back(std::move(goal));
  return ends;
}

/// Returns start and goal of a request for online replanning, all axes: the present goal if it is
/// still among the goals, else the first one.
std::vector<Vector> ends_of(const Problem& problem, const Vector& goal_so_far) {
  Vector goal = problem.start;
  goal(problem.axes) = std::count(problem.goals.begin(), problem.goals.end(), goal_so_far) > 0
                           ? goal_so_far
                           : problem.goals.front();
  return {problem.start, goal};
}

/// Covers the links with spheres in advance, which takes up to 0.5 s and is cached in the process.
void cover_links(CollisionWorld& world, const RobotModel& robot) {
  std::vector<int> all(static_cast<std::size_t>(robot.dof()));
  std::iota(all.begin(), all.end(), 0);
  world.set_moving_axes(all);
  world.is_free(robot.rest_configuration());
  world.set_moving_axes({});
}

Result plan_in_cartesian_space(const PlanningModels& models, const PlanningTask& task,
                               const PoseGoal& pose, const CartesianSettings& settings,
                               const Hooks& hooks) {
  const PathRequest& request = task.request;
  const Problem& problem = task.problem;
  CartesianProblem cartesian;
  cartesian.start = problem.start;
  cartesian.T_root_goal = pose.T_root_tip;
  cartesian.also.assign(request.also.begin(), request.also.end());
  cartesian.also_goal = request.also_goal;
  cartesian.seed = problem.seed;
  cartesian.budget = problem.budget;
  std::vector<int> columns = problem.axes;
  columns.insert(columns.end(), cartesian.also.begin(), cartesian.also.end());
  return in_joints(
      plan_cartesian(models.robot, models.world, models.cost, cartesian, settings, hooks), columns);
}

}  // namespace

Solver::Solver(std::shared_ptr<const RobotModel> robot, std::optional<RobotModel> mobile,
               const ObjectLibrary& objects, const CostSettings& weights,
               const SolverSettings& settings)
    : robot_(std::move(robot)),
      on_platform_(std::move(mobile)),
      objects_(objects),
      weights_(weights),
      settings_(settings),
      world_(*robot_, objects),
      cost_(*robot_, weights) {
  cover_links(world_, *robot_);
  if (on_platform_ && drives(*robot_)) prepare_mobile();
}

void Solver::prepare_mobile() {
  if (!mobile_) mobile_ = std::make_unique<Mobile>(*on_platform_, objects_, weights_);
}

bool Solver::drives_platform(const PathRequest& request) const {
  return on_platform_ && is_of_platform(request.group);
}

std::string Solver::complete(PathRequest& request, const Pose& T_world_base) const {
  if (!drives_platform(request)) return contradiction(*robot_, request);
  constexpr double kMaxTilt = 0.02;  // max tilt of a level platform [rad]
  if (!(T_world_base.linear()(2, 2) > std::cos(kMaxTilt)))
    return "the platform does not stand level: it cannot be planned for";
  if (!drives(*robot_) && request.start.size() == robot_->dof())
    request.start = with_platform(request.start, T_world_base);
  return contradiction(*on_platform_, request);
}

PlanningTask Solver::make_task(const PathRequest& request,
                               std::shared_ptr<const Scene> scene) const {
  PlanningTask task;
  task.request = request;
  task.T_world_root = scene->T_world_base;
  const bool platform_motion = drives_platform(request);
  if (platform_motion && !drives(*robot_))
    task.T_world_root = make_pose({0, 0, scene->T_world_base.translation().z()});
  task.problem = problem_of(platform_motion ? *on_platform_ : *robot_, request, task.T_world_root);
  task.scene = std::move(scene);
  return task;
}

Solver::Selected Solver::select(const PathRequest& request) {
  if (!drives_platform(request)) return {{*robot_, world_, cost_}, nullptr};
  prepare_mobile();
  return {{*on_platform_, mobile_->world, mobile_->cost}, &mobile_->navigation};
}

/// Sets people with the digits of those who hold objects. A hand that touches a person's digits at
/// the start has to leave them: they do not count.
static void set_people(CollisionWorld& world, const PlanningTask& task) {
  std::vector<OtherRobot> digits = task.digits;
  for (;;) {
    HumanState with_digits = *task.people;
    with_digits.robots.insert(with_digits.robots.end(), digits.begin(), digits.end());
    world.set_people(with_digits);
    if (digits.empty()) return;
    const CollisionVerdict at_start = world.check_people(task.problem.start);
    const auto is_touched = [&](const OtherRobot& of) { return of.name == at_start.id; };
    if (at_start.free || std::erase_if(digits, is_touched) == 0) return;
  }
}

void Solver::set_world(const Selected& selected, PlanningTask& task) {
  CollisionWorld& world = selected.models.world;
  Scene scene = *task.scene;
  scene.T_world_base = task.T_world_root;
  world.set_scene(scene);
  world.set_turning_margin(0);
  world.set_attachment(task.request.attachment, task.request.allowed_contacts);
  set_people(world, task);
  if (!task.request.running.empty()) {
    world.set_moving_axes(task.problem.axes);
    const std::vector<Vector> ends = ends_of(task.problem, task.request.running.back());
    if (selected.navigation != nullptr) {
      FurnitureRoom clearance = settings_.furniture;
      clearance.room *= settings_.driven_room_fraction;
      keep_clear_of_furniture(world, scene, clearance, ends);
    } else {
      set_scene_with_margins(world, scene, settings_.replan_margins, ends);
    }
  }
  selected.models.cost.set_people(*task.people);
  selected.models.cost.set_layers(task.layers);
  selected.models.cost.set_gain(task.cost_gain);
  selected.models.cost.set_base(task.T_world_root);
  if (selected.navigation != nullptr) {
    selected.navigation->set_people(*task.people, task.T_world_root);
    drive(selected.models.robot, *selected.navigation, settings_.roam, task.problem);
  }
}

void Solver::solve(PlanningTask& task, const Hooks& hooks) {
  const Selected selected = select(task.request);
  set_world(selected, task);
  const std::uint64_t budget = task.problem.budget;
  std::uint64_t spent = 0;
  if (keep_clearance(selected, task)) {
    task.problem.budget = budget / 2;
    solve_once(selected, task, hooks);
    selected.models.world.set_obstacles({});
    if (!task.result.solved) set_world(selected, task);
    spent = task.result.checks;
  }
  if (!task.result.solved && !(hooks.cancelled && hooks.cancelled())) {
    task.problem.budget = budget - std::min(spent, budget - 1);
    solve_once(selected, task, hooks);
    task.result.checks += spent;
  }
}

void Solver::solve_once(const Selected& selected, PlanningTask& task, const Hooks& hooks) {
  if (task.request.running.empty()) {
    task.result = plan_new(selected, task, hooks);
    return;
  }
  ReplanResult live = continue_path(selected.models, task.problem, task.request.running,
                                    settings_.search, settings_.live, hooks);
  task.outcome = live.outcome;
  task.result = std::move(live.result);
}

/// Adds clearance to heads for planning between configurations and returns it [m]; returns 0 for
/// all other requests, such as straight lines.
double Solver::keep_head_clearance(const Selected& selected, const PlanningTask& task) const {
  CollisionWorld& world = selected.models.world;
  const Problem& problem = task.problem;
  world.set_obstacles({});
  if (task.request.straight || problem.goals.empty() || selected.navigation != nullptr ||
      task.request.space == PlanSpace::cartesian)
    return 0;
  world.set_moving_axes(problem.axes);
  const Group& group = *selected.models.robot.group(task.request.group);
  std::vector<Vector> goals;
  for (const Vector& goal : problem.goals)
    goals.push_back(RobotModel::with(problem.start, group, goal));
  return keep_clear_of_heads(world, *task.people, settings_.head_room, problem.start, goals);
}

/// Adds the clearance that start and goal allow: of an arm to heads, of a platform to furniture.
/// Returns whether there is any.
bool Solver::keep_clearance(const Selected& selected, const PlanningTask& task) const {
  if (selected.navigation == nullptr) return keep_head_clearance(selected, task) > 0;
  if (!task.request.running.empty() || settings_.furniture.room == 0) return false;
  Scene scene = *task.scene;
  scene.T_world_base = task.T_world_root;
  keep_clear_of_furniture(selected.models.world, scene, settings_.furniture,
                          first_ends_of(task.problem));
  return true;
}

Result Solver::plan_new(const Selected& selected, PlanningTask& task, const Hooks& hooks) {
  const auto& [robot, world, cost] = selected.models;
  const std::vector<PoseGoal> poses = pose_goals(task.request, task.T_world_root);
  if (task.request.space == PlanSpace::cartesian)
    return plan_in_cartesian_space(selected.models, task, poses.front(), settings_.cartesian,
                                   hooks);
  if (poses.empty()) return plan(robot, world, cost, task.problem, settings_.search, hooks);
  return plan_to_poses(selected, poses, task, hooks);
}

Result Solver::plan_to_poses(const Selected& selected, const std::vector<PoseGoal>& poses,
                             PlanningTask& task, const Hooks& hooks) {
  const auto& [robot, world, cost] = selected.models;
  Problem& problem = task.problem;
  PoseGoals found =
      selected.navigation != nullptr
          ? reach_with_platform(robot, world, poses, problem.start, problem.seed,
                                settings_.sampling)
          : reach(robot, *robot.group(task.request.group), poses, problem.start, problem.seed);
  problem.goals = std::move(found.goals);
  Result result;
  result.reason = found.reason;
  if (selected.navigation != nullptr) drive(robot, *selected.navigation, settings_.roam, problem);
  if (!problem.goals.empty()) result = plan(robot, world, cost, problem, settings_.search, hooks);
  if (result.solved) result.goal = found.pose[result.goal];
  return result;
}

}  // namespace handsel::path_planner
