// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/commands/plan_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>

#include <unistd.h>

#include "common/config/resources.hpp"
#include "components/path_planner/cartesian.hpp"
#include "components/path_planner/driving.hpp"
#include "components/path_planner/path_planner.hpp"
#include "components/path_planner/pose_goals.hpp"
#include "deploy/handsel/cli/json_lines.hpp"
#include "deploy/handsel/offline/scene_lines.hpp"
#include "deploy/handsel/pictures/landscape.hpp"

namespace handsel {
namespace {

using namespace command;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr double kCartesianChecks = 1e5;  // per second; divided among the branches of the goal

struct Options {
  std::string robot, srdf, group, planner{"auto"}, space{"joint"};
  double time{5.0}, platform_margin{3.0};
  std::uint64_t checks{0}, seed{1};
  bool ompl{false}, json_lines{false}, landscape{false};
  std::string png;
};

const std::map<std::string, PlannerKind> kPlanners = {{"auto", PlannerKind::automatic},
                                                      {"rrt", PlannerKind::rrt},
                                                      {"rrtconnect", PlannerKind::rrt_connect},
                                                      {"trrt", PlannerKind::trrt},
                                                      {"bitrrt", PlannerKind::bitrrt}};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

RobotModel load_robot(const Options& options) {
  if (options.robot.ends_with(".urdf")) return RobotModel::load_urdf(options.robot, options.srdf);
  if (!options.srdf.empty())
    throw ConfigError("--srdf belongs to a .urdf; a robot description names its own");
  const std::filesystem::path description = robot_description(options.robot);
  RobotModel robot = RobotModel::load(description);
  if (!path_planner::is_of_platform(options.group)) return robot;
  if (auto mobile = on_platform(robot, description)) return *std::move(mobile);
  throw ConfigError(description.string() + " tells of no platform, which the group \"" +
                    options.group + "\" is about");
}

class Batch {
 public:
  explicit Batch(const Options& options)
      : options_(options), robot_(load_robot(options)), world_(robot_, nullptr) {
    if (!options.group.empty()) group_ = robot_.group(options.group);
  }

  json answer(const json& item) {
    const std::string of_item =
        item.is_object() ? item.value("group", options_.group) : options_.group;
    if (!options_.group.empty() && of_item != options_.group)
      throw LineError("the problem is for the group \"" + of_item + "\", not for \"" +
                      options_.group + "\"");
    path_planner::Problem problem;
    problem.planner = kPlanners.at(options_.planner);
    problem.stock = options_.ompl;
    problem.seed = options_.seed;
    problem.budget = options_.checks > 0 ? options_.checks : UINT64_MAX / 2;
    problem.start = configuration_in(robot_, field(item, "start"), "start");
    const HumanState people = people_in(item);
    HumanCost cost(robot_, weights_in(item));
    cost.set_people(people);
    world_.set_obstacles(obstacles_in(item));
    world_.set_people(people);
    const bool cartesian = options_.space == "cartesian";
    const std::string unreached = cartesian ? "" : read_goals(item, problem);
    read_upright(item, problem);
    std::optional<NavigationCost> navigation;
    if (path_planner::is_of_platform(options_.group)) {
      navigation.emplace(robot_, weights_in(item));
      navigation->set_people(people);
      path_planner::drive(robot_, *navigation, options_.platform_margin, problem);
    }

    const Clock::time_point begin = Clock::now();
    Clock::time_point smoothing = begin;
    bool smoothed = false;
    path_planner::Hooks hooks;
    if (options_.checks == 0)
      hooks.cancelled = [&] { return seconds_since(begin) > options_.time; };
    hooks.entered = [&](path_planner::Stage stage) {
      if (stage == path_planner::Stage::smooth && !smoothed) smoothing = Clock::now();
      smoothed = smoothed || stage == path_planner::Stage::smooth;
    };
    path_planner::Result result;
    result.reason = unreached;
    if (cartesian)
      result = in_the_cartesian_space(item, cost, problem, hooks);
    else if (unreached.empty())
      result = path_planner::plan(robot_, world_, cost, problem, {}, hooks);
    const double total = seconds_since(begin);
    const double search =
        smoothed ? std::chrono::duration<double>(smoothing - begin).count() : total;
    ++asked_;
    solved_ += result.solved;
    if (isatty(STDERR_FILENO) != 0) std::fprintf(stderr, "\r%d of %d solved ", solved_, asked_);

    json path = json::array();
    for (const Vector& q : result.path) path.push_back(std::vector<double>(q.begin(), q.end()));
    std::vector<std::string> names;
    for (int i : problem.axes) names.push_back(robot_.axes()[i].name);
    std::string reason = result.reason;
    if (!result.solved && result.cancelled) {
      char text[64];
      std::snprintf(text, sizeof text, "no path within %.1f s", options_.time);
      reason = text;
    }
    return {{"set", item.value("set", "")},
            {"idx", item.contains("idx") ? item["idx"] : json(asked_)},
            {"solved", result.solved},
            {"plan_s", search},
            {"simplify_s", total - search},
            {"path", path},
            {"joint_names", names},
            {"length", result.length},
            {"cost", result.cost},
            {"work", result.work},
            {"checks", result.checks},
            {"planner", result.planner},
            {"reason", reason}};
  }

  bool all_solved() const { return solved_ == asked_; }

 private:
  static void read_upright(const json& item, path_planner::Problem& problem) {
    const auto upright = item.find("upright");
    if (upright == item.end()) return;
    problem.upright.emplace();
    problem.upright->max_angle = number(*upright, "max_angle");
    if (upright->contains("axis")) problem.upright->axis_tool = vector3(*upright, "axis");
    if (!(problem.upright->axis_tool.norm() > 1e-9))
      throw LineError("\"axis\" of \"upright\" must not be zero");
  }

  /// Stores the axes of the path in the problem.
  path_planner::Result in_the_cartesian_space(const json& item, HumanCost& cost,
                                              path_planner::Problem& problem,
                                              const path_planner::Hooks& hooks) {
    const json& goals = field(item, "goals");
    if (!goals.is_array() || goals.size() != 1 || !goals[0].contains("pose") ||
        goals[0].contains("slack") || goals[0].contains("turn"))
      throw LineError(
          "in the Cartesian space \"goals\" must be one {\"pose\": {\"p\", \"q\"}}, without slack "
          "or turn");
    if (problem.upright) throw LineError("\"upright\" is kept in the joint space only");
    if (group_ == nullptr || group_->name != "arm")
      throw LineError("the Cartesian space is that of --group arm");
    path_planner::CartesianProblem asked;
    asked.start = problem.start;
    asked.T_root_goal =
        make_pose(vector3(goals[0]["pose"], "p"), quaternion(goals[0]["pose"], "q"));
    asked.seed = problem.seed;
    asked.budget = options_.checks > 0
                       ? options_.checks
                       : static_cast<std::uint64_t>(kCartesianChecks * options_.time);
    const json also = item.value("also", json::object());
    asked.also_goal.resize(static_cast<Eigen::Index>(also.size()));
    for (const auto& [name, value] : also.items()) {
      asked.also.push_back(axis_of(robot_, name));
      asked.also_goal[static_cast<Eigen::Index>(asked.also.size()) - 1] =
          number(also, name.c_str());
    }
    problem.axes = group_->axes;
    problem.axes.insert(problem.axes.end(), asked.also.begin(), asked.also.end());
    return path_planner::in_joints(
        path_planner::plan_cartesian(robot_, world_, cost, asked, {}, hooks), problem.axes);
  }

  /// Returns the reason if no configuration reaches the goals, or an empty text.
  std::string read_goals(const json& item, path_planner::Problem& problem) {
    const json& goals = field(item, "goals");
    if (!goals.is_array() || goals.empty())
      throw LineError("\"goals\" must be a list of at least one goal");
    if (goals[0].contains("pose")) return read_poses(goals, problem);
    if (group_ != nullptr) {
      problem.axes = group_->axes;
    } else {
      for (const auto& [name, value] : goals[0].items())
        problem.axes.push_back(axis_of(robot_, name));
      std::sort(problem.axes.begin(), problem.axes.end());
    }
    for (const json& goal : goals) {
      if (goal.size() != problem.axes.size())
        throw LineError("a goal names " + std::to_string(goal.size()) + " axes, " +
                        std::to_string(problem.axes.size()) + " are planned for");
      Vector q(problem.axes.size());
      for (std::size_t i = 0; i < problem.axes.size(); ++i)
        q[static_cast<Eigen::Index>(i)] = number(goal, robot_.axes()[problem.axes[i]].name.c_str());
      problem.goals.push_back(q);
    }
    return {};
  }

  std::string read_poses(const json& goals, path_planner::Problem& problem) {
    if (group_ == nullptr || group_->tip < 0 || group_->name == kPlatformGroup)
      throw LineError("goals that are poses need a --group with a tip link");
    problem.axes = group_->axes;
    std::vector<path_planner::PoseGoal> poses;
    for (const json& goal : goals) {
      const json& pose = field(goal, "pose");
      path_planner::PoseGoal one;
      one.T_root_tip = make_pose(vector3(pose, "p"), quaternion(pose, "q"));
      if (goal.contains("slack")) one.slack = vector3(goal, "slack");
      if (goal.contains("turn")) one.turn = number(goal, "turn");
      if (one.slack.minCoeff() < 0 || one.turn < 0)
        throw LineError("\"slack\" and \"turn\" must not be negative");
      poses.push_back(one);
    }
    path_planner::PoseGoals found =
        path_planner::is_of_platform(group_->name)
            ? path_planner::reach_with_platform(robot_, world_, poses, problem.start, problem.seed)
            : path_planner::reach(robot_, *group_, poses, problem.start, problem.seed);
    problem.goals = std::move(found.goals);
    return found.reason;
  }

  const Options& options_;
  RobotModel robot_;
  CollisionWorld world_;
  const Group* group_{nullptr};
  int asked_{0}, solved_{0};
};

std::string row(const json& result) {
  char text[320];
  std::snprintf(
      text, sizeof text,
      "%-24s %4s  %-10s %8.1f ms + %6.1f ms  %3zu nodes  %6.2f rad  cost %7.3f  %9llu checks  %s",
      result["set"].get<std::string>().c_str(), result["idx"].dump().c_str(),
      result["solved"].get<bool>() ? result["planner"].get<std::string>().c_str() : "no path",
      1e3 * result["plan_s"].get<double>(), 1e3 * result["simplify_s"].get<double>(),
      result["path"].size(), result["length"].get<double>(), result["cost"].get<double>(),
      static_cast<unsigned long long>(result["checks"].get<std::uint64_t>()),
      result["reason"].get<std::string>().c_str());
  return text;
}

int run_landscape(const Options& options) {
  const LandscapeResult result = plan_on_landscape(kPlanners.at(options.planner), options.seed);
  if (!options.png.empty()) {
    std::ofstream file(options.png, std::ios::binary);
    file << result.png;
    if (!file.flush()) throw ConfigError(options.png + ": cannot be written");
    std::fprintf(stderr, "wrote %s\n", options.png.c_str());
  }
  if (options.json_lines || isatty(STDOUT_FILENO) == 0) {
    std::cout << result.answer.dump() << "\n";
  } else {
    std::printf("%s, %zu nodes, length %.3f, integral cost %.4f, work %.4f\n",
                result.answer["solved"].get<bool>() ? "a path" : "no path",
                result.answer["nodes"].get<std::size_t>(), result.answer["length"].get<double>(),
                result.answer["cost"].get<double>(), result.answer["work"].get<double>());
  }
  return result.answer["solved"].get<bool>() ? 0 : 1;
}

int run(const Options& options) {
  if (options.landscape) return run_landscape(options);
  if (!options.png.empty())
    throw ConfigError("--png draws the planners on a landscape of costs: give --landscape, too");
  if (options.robot.empty())
    throw ConfigError("--robot is missing: a .urdf, or a robot description by name or file");
  if (!(options.platform_margin > 0)) throw ConfigError("--platform-margin must be greater than 0");
  if (!(options.time > 0)) throw ConfigError("--time must be greater than 0");
  Batch batch(options);
  const bool for_people = !options.json_lines && isatty(STDOUT_FILENO) != 0;
  const int code = for_each_line(
      std::cin, std::cout, [&](const json& item) { return batch.answer(item); },
      for_people ? row : std::function<std::string(const json&)>{});
  if (isatty(STDERR_FILENO) != 0) std::fprintf(stderr, "\n");
  return code != 0 ? code : batch.all_solved() ? 0 : 1;
}

}  // namespace

void add_plan_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* plan = app.add_subcommand(
      "plan", "computes collision-free paths; reads one line of JSON for each problem from stdin");
  plan->footer(
      R"(Input line: {"start": {joint: rad}, "goals": [{joint: rad}] or [{"pose": {"p": [x, y, z],
"q": [x, y, z, w]} of the group's tip in the root frame, "slack": [x, y, z], "turn": rad}],
"obstacles": [{"id", "type": "box|cylinder|sphere", "dims", "pos", "quat_xyzw"}], "human":
{"joints": {name: [x, y, z]}, "gaze": [x, y, z]}, "weights": {"safety", "visibility",
"comfort"}, "also": {joint: rad} where head or hand end (--space cartesian), "upright":
{"axis": [x, y, z] of the tool frame, "max_angle": rad from up}}; dims of a cylinder: height,
radius.)");
  plan->add_option("--robot", options->robot, "a .urdf, or a robot description by name or file");
  plan->add_option(
      "--srdf", options->srdf,
      "SRDF file that names the pairs of links that are never tested against each other");
  plan->add_option("--group", options->group,
                   "group of axes (default: if the robot names no groups, the axes of the goals). "
                   "A robot with a platform has the groups \"platform\" and \"robot\" (platform "
                   "and arm) too: platform_x, platform_y [m], platform_heading [rad]");
  plan->add_option("--platform-margin", options->platform_margin,
                   "max distance of a platform from the box around its start and goals [m]");
  plan->add_option("--planner", options->planner, "planning algorithm")
      ->check(CLI::IsMember(kPlanners));
  plan->add_option(
          "--space", options->space,
          "space of the search: joint, or cartesian (pose of the tool and angle of the elbow)")
      ->check(CLI::IsMember({"joint", "cartesian"}));
  plan->add_flag("--ompl", options->ompl, "use OMPL's planner of that name");
  plan->add_option("--time", options->time, "max time for each problem [s]");
  plan->add_option(
      "--checks", options->checks,
      "max number of checked states for each problem instead of --time; the result is repeatable");
  plan->add_option("--seed", options->seed, "seed of all random choices");
  plan->add_flag("--landscape", options->landscape,
                 "instead of problems: search on an example cost map over two axes");
  plan->add_option("--png", options->png,
                   "file for a picture of the cost map, the search trees and the path");
  plan->add_flag("--json", options->json_lines, "print JSON Lines also on a terminal");
  plan->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace handsel
