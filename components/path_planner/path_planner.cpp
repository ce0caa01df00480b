// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/path_planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "components/path_planner/search/search.hpp"
#include "components/path_planner/search/smoothing.hpp"

namespace handsel::path_planner {
namespace {

std::string contact(const CollisionVerdict& verdict) {
  return verdict.first + " touches " + verdict.second;
}

const char* name_of(PlannerKind kind) {
  switch (kind) {
    case PlannerKind::rrt:
      return "rrt";
    case PlannerKind::trrt:
      return "trrt";
    case PlannerKind::bitrrt:
      return "bitrrt";
    default:
      return "rrtconnect";
  }
}

std::string format(const char* pattern, double a, double b) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, a, b);
  return text;
}

/// Returns why the problem is invalid, one sentence; empty: valid.
std::string contradiction(const RobotModel& robot, const Problem& problem) {
  if (problem.start.size() != robot.dof())
    return format("the start has %.0f axes, the robot has %.0f",
                  static_cast<double>(problem.start.size()), robot.dof());
  if (!problem.start.allFinite()) return "the start is not finite";
  if (problem.axes.empty()) return "no axes to plan for";
  for (int axis : problem.axes)
    if (axis < 0 || axis >= robot.dof())
      return format("axis %.0f is none of the robot's %.0f", axis, robot.dof());
  if (problem.goals.empty()) return "no goal was given";
  for (const Vector& goal : problem.goals) {
    if (goal.size() != static_cast<Eigen::Index>(problem.axes.size()))
      return format("a goal has %.0f axes, the group has %.0f", static_cast<double>(goal.size()),
                    static_cast<double>(problem.axes.size()));
    if (!goal.allFinite()) return "a goal is not finite";
  }
  if (problem.budget == 0) return "the time limit is zero";
  if (problem.upright) {
    if (!(problem.upright->max_angle > 0 && problem.upright->max_angle < M_PI))
      return format("what is held may lean %.3f rad, but the bound must be above 0 and below %.3f",
                    problem.upright->max_angle, M_PI);
    if (!(problem.upright->axis_tool.norm() > 1e-9) || !(problem.upright->up_root.norm() > 1e-9))
      return "the axis that stays upright, and up, must not be zero";
  }
  return {};
}

void finish(const SearchSpace& space, Result& result) {
  for (std::size_t i = 1; i < result.path.size(); ++i) {
    result.cost += space.costs().integral(result.path[i - 1], result.path[i]);
    result.work += space.costs().work(result.path[i - 1], result.path[i]);
  }
  result.length = path_length(result.path);
  result.solved = true;
}

class Planning {
 public:
  Planning(SearchSpace& space, const Problem& problem, const Settings& settings)
      : space_(space), problem_(problem), settings_(settings) {}

  Result run() {
    if (!ends_free()) return result_;
    if (problem_.straight) return straight_line();
    for (int attempt = 0; attempt < settings_.max_attempts && !space_.exhausted(); ++attempt) {
      const bool in_batches = attempt == 0;
      space_.set_step(attempt < 2 ? settings_.step : settings_.fine_step_ratio * settings_.step);
      max_checks_ = in_batches ? static_cast<std::uint64_t>(settings_.first_budget_fraction *
                                                            static_cast<double>(problem_.budget))
                               : problem_.budget;
      space_.limit(max_checks_);
      if (in_batches) space_.check_in_batches(goals_, settings_.near_ends);
      const bool found = find(problem_.seed + static_cast<std::uint64_t>(attempt) * 7919);
      space_.check_exactly();
      space_.limit(problem_.budget);
      if (!found && in_batches && !space_.cancelled()) continue;
      if (!found) return result_;
      if (verified() || smoothed_finely() || unsmoothed()) {
        finish(space_, result_);
        return result_;
      }
    }
    if (result_.reason.empty() || space_.cancelled()) out_of_budget(0);
    result_.path.clear();
    return result_;
  }

 private:
  bool ends_free() {
    const Vector start = space_.start();
    if (std::string why = space_.outside_limits(start); !why.empty())
      return refuse("the start: " + why);
    if (std::string why = leans(start); !why.empty()) return refuse("the start: " + why);
    const CollisionVerdict at_start =
        space_.free(start) ? CollisionVerdict{} : space_.verdict(start);
    if (!at_start.free) {
      result_.start_touches = at_start.id;
      return refuse("the start is in collision: " + contact(at_start));
    }
    std::string first;
    for (std::size_t i = 0; i < problem_.goals.size(); ++i) {
      std::string why = space_.outside_limits(problem_.goals[i]);
      if (why.empty()) why = leans(problem_.goals[i]);
      if (why.empty()) {
        const CollisionVerdict verdict =
            space_.free(problem_.goals[i]) ? CollisionVerdict{} : space_.verdict(problem_.goals[i]);
        if (verdict.free) {
          goals_.push_back(problem_.goals[i]);
          goal_index_.push_back(i);
          continue;
        }
        why = "in collision: " + contact(verdict);
      }
      if (first.empty()) first = why;
      if (problem_.straight) break;
    }
    if (goals_.empty())
      return refuse((problem_.goals.size() == 1 || problem_.straight
                         ? "the goal is not possible, "
                         : "none of the " + std::to_string(problem_.goals.size()) +
                               " goals is possible, the first ") +
                    first);
    return true;
  }

  std::string leans(const Vector& q) const {
    if (space_.upright().holds(q)) return {};
    return format("what is held leans %.3f rad over, at most %.3f are allowed",
                  space_.upright().tilt(q), problem_.upright->max_angle);
  }

  Result straight_line() {
    if (!space_.upright().holds_on_line(space_.start(), goals_.front())) {
      refuse("on the straight line what is held leans over too far");
      return result_;
    }
    result_.path = {space_.start(), goals_.front()};
    result_.goal = goal_index_.front();
    result_.planner = "straight";
    const CollisionVerdict verdict =
        space_.motion_verdict(result_.path[0], result_.path[1], settings_.verify_step);
    if (!verdict.free) {
      result_.path.clear();
      refuse("the straight line is blocked: " + contact(verdict));
      return result_;
    }
    finish(space_, result_);
    return result_;
  }

  /// Searches with restarts, each after twice as many checks, because search times have a
  /// heavy-tailed distribution.
  Found search_restarting(PlannerKind kind, bool heed_cost, std::uint64_t seed) {
    const std::uint64_t limit = space_.limit();
    Found best;
    best.closest = std::numeric_limits<double>::infinity();
    for (std::uint64_t tree_checks = settings_.first_tree_checks;; tree_checks *= 2) {
      const std::uint64_t before = space_.checks();
      space_.limit(std::min(limit, before + tree_checks));
      Found found = search(space_, goals_, kind, heed_cost, seed);
      seed += 104729;
      space_.limit(limit);
      if (!found.path.empty()) return found;
      if (found.closest < best.closest) best = found;
      if (space_.exhausted() || space_.checks() == before)
        return best;  // a refused start uses no checks
    }
  }

  bool find(std::uint64_t seed) {
    space_.enter(Stage::search);
    const Vector start = space_.start();
    std::vector<Vector> direct;
    for (std::size_t i = 0; i < goals_.size() && direct.empty(); ++i)
      if (space_.motion_clear(start, goals_[i])) {
        direct = {start, goals_[i]};
        result_.goal = goal_index_[i];
      }
    const bool people = space_.costs().concerns_people();
    const bool asked = problem_.planner != PlannerKind::automatic;
    Found found;
    if (!direct.empty() && !asked && !people) {
      result_.path = direct;
      result_.planner = "straight";
    } else {
      const PlannerKind kind = problem_.planner;
      bool heeds_cost = people;
      if (!asked && people)
        space_.limit(
            space_.checks() +
            static_cast<std::uint64_t>(
                settings_.search_fraction *
                static_cast<double>(max_checks_ - std::min(max_checks_, space_.checks()))));
      found = search_restarting(kind, heeds_cost, seed);
      space_.limit(max_checks_);
      if (found.path.empty() && !asked && people && !space_.exhausted() && direct.empty()) {
        heeds_cost = false;
        found = search_restarting(kind, heeds_cost, seed + 1);
      }
      if (found.path.empty() && direct.empty()) return out_of_budget(found.closest);
      if (found.path.empty()) {
        result_.path = direct;
        result_.planner = "straight";
      } else {
        result_.path = found.path;
        result_.goal = goal_index_[found.goal];
        result_.planner = name_of(asked        ? kind
                                  : heeds_cost ? PlannerKind::bitrrt
                                               : PlannerKind::rrt_connect);
      }
    }
    raw_ = result_.path;
    space_.enter(Stage::smooth);
    Random random(seed);
    smooth(space_, result_.path, random);
    if (people && !asked && !direct.empty() && result_.path != direct) {
      const std::size_t other = result_.goal;
      std::vector<Vector> smoothed = direct;
      smooth(space_, smoothed, random);
      if (space_.costs().price(smoothed) < space_.costs().price(result_.path)) {
        result_.path = smoothed;
        raw_ = direct;
        result_.planner = "straight";
        for (std::size_t i = 0; i < goals_.size(); ++i)
          if (goals_[i] == smoothed.back()) result_.goal = goal_index_[i];
      } else {
        result_.goal = other;
      }
    }
    prune(space_, result_.path);
    return true;
  }

  /// Repeats the smoothing with a finer step, because a path shifted by less than a step may touch
  /// an obstacle.
  bool smoothed_finely() {
    if (space_.cancelled()) return false;
    space_.enter(Stage::smooth);
    space_.set_step(settings_.fine_step_ratio * settings_.step);
    result_.path = raw_;
    Random random(problem_.seed);
    smooth(space_, result_.path, random);
    prune(space_, result_.path);
    return verified();
  }

  /// Returns whether the path before smoothing passes the fine check.
  bool unsmoothed() {
    result_.path = raw_;
    return verified();
  }

  bool verified() {
    space_.enter(Stage::verify);
    for (std::size_t i = 1; i < result_.path.size(); ++i) {
      if (!space_.upright().holds_on_line(result_.path[i - 1], result_.path[i]))
        return refuse("what is held leans over too far on every path found");
      const CollisionVerdict verdict =
          space_.motion_verdict(result_.path[i - 1], result_.path[i], settings_.verify_step);
      if (verdict.free) continue;
      result_.reason = "every path found fails the fine check: " + contact(verdict);
      return false;
    }
    result_.reason.clear();
    return true;
  }

  bool refuse(const std::string& why) {
    result_.reason = why;
    return false;
  }

  bool out_of_budget(double closest) {
    result_.path.clear();
    result_.cancelled = space_.cancelled();
    if (result_.cancelled) return refuse("cancelled");
    return refuse(format(
        "no path within %.0f checks; the search came within %.3f rad of joining start and goal",
        static_cast<double>(problem_.budget), closest));
  }

  SearchSpace& space_;
  const Problem& problem_;
  const Settings& settings_;
  std::vector<Vector> goals_;
  std::vector<std::size_t> goal_index_;
  std::vector<Vector> raw_;
  std::uint64_t max_checks_{};  // max checks of this attempt
  Result result_;
};

}  // namespace

Result plan(const RobotModel& robot, CollisionWorld& world, HumanCost& cost, const Problem& problem,
            const Settings& settings, const Hooks& hooks) {
  Result result;
  result.reason = contradiction(robot, problem);
  if (!result.reason.empty()) return result;
  world.set_moving_axes(problem.axes);
  cost.set_moving_axes(problem.axes);
  SearchSpace space(robot, world, cost, problem, settings, hooks);
  result = Planning(space, problem, settings).run();
  result.checks = space.checks();
  return result;
}

}  // namespace handsel::path_planner
