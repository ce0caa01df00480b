// Hierarchical task network planning: a task is decomposed by its methods down to actions; the
// cheapest decomposition is the plan. Pure.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "components/supervisor/task/domain.hpp"

namespace handsel::supervisor {

/// An action with its arguments.
struct PlannedAction {
  ActionKind kind{};                   ///< of the ActionGoal
  std::string object, human, surface;  ///< of the ActionGoal; empty: none
  int action{-1};                      ///< index in the domain
  std::vector<std::string> args;       ///< of the domain's action
  double cost{};                       ///< with extra costs in the state of the plan
  std::string text() const;            ///< "give mug to anna"
  /// Returns whether the object is to stand on a surface at the end, by one hand or another.
  bool puts_down() const {
    return kind == ActionKind::place || (kind == ActionKind::regrasp && !surface.empty());
  }
  friend bool operator==(const PlannedAction& a, const PlannedAction& b) {
    return a.action == b.action && a.args == b.args;
  }
};

/// A line of the tree: a task, or one of the actions.
struct PlanLine {
  std::string text;       ///< phrase for people
  std::uint32_t depth{};  ///< 0: the goal
  int action{-1};         ///< index into Plan::actions; -1: a task
  bool skipped{false};    ///< true: nothing is planned for the line, see `reason`
  std::string reason;     ///< why the line is skipped, for people; else empty
};

/// Result of make_plan().
struct Plan {
  bool found{false};                   ///< true: `actions` carry out the task
  std::vector<PlannedAction> actions;  ///< in order; none: nothing has to be done
  std::vector<PlanLine> tree;          ///< depth first; the first line is the goal
  double cost{};                       ///< of methods, actions and what is skipped
  bool proven{false};                  ///< nothing cheaper exists; else the search was cut short
  std::uint64_t nodes{};               ///< states expanded
  std::string reason;                  ///< why there is none, one sentence for people
};

/// What it leaves out, and why: "clear box away: box is out of the robot's reach; ..."; empty:
/// nothing.
std::string left_out(const Plan& plan);

/// Limits of the search.
struct PlanLimits {
  std::uint64_t nodes{4000};  ///< largest number of states expanded
  std::uint32_t depth{64};    ///< largest depth of decomposition
};

/// What an action must not be tried again for, by its text.
using Forbidden = std::map<std::string, std::string>;

/// Branch and bound: methods and bindings cheapest first, by their cost and a lower bound of
/// what they lead to; an alternative that costs as much as the best one found is left. The same
/// question has the same answer. `args`: of the task, "-" = left out.
Plan make_plan(const Domain& domain, const World& world, int task,
               const std::vector<std::string>& args, const Forbidden& forbidden,
               const PlanLimits& limits);

}  // namespace handsel::supervisor
