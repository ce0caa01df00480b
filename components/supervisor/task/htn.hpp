// SPDX-License-Identifier: Apache-2.0
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
  bool both_hands{};                   ///< of the ActionGoal
  std::string text() const;            ///< "give mug to anna"
  /// Returns whether the action ends with the object on a surface.
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
  double cost{};                       ///< sum of methods, actions and skipped lines
  bool proven{false};                  ///< true: minimal cost; false: the search reached a limit
  std::uint64_t nodes{};               ///< states expanded
  std::string reason;                  ///< why no plan was found, one sentence for people
};

/// Returns the skipped lines with reasons, such as "clear box away: box is out of the robot's
/// reach; ..."; empty: none.
std::string left_out(const Plan& plan);

/// Limits of the search.
struct PlanLimits {
  std::uint64_t nodes{4000};  ///< max number of expanded states
  std::uint32_t depth{64};    ///< max depth of decomposition
};

/// Reasons why actions are forbidden, by the text of the action.
using Forbidden = std::map<std::string, std::string>;

/// Plans by branch and bound: methods and bindings in order of cost plus a lower bound of the
/// rest; prunes an alternative that costs at least as much as the best plan. Deterministic.
/// `args`: of the task, "-" = omitted.
Plan make_plan(const Domain& domain, const World& world, int task,
               const std::vector<std::string>& args, const Forbidden& forbidden,
               const PlanLimits& limits);

}  // namespace handsel::supervisor
