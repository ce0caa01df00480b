// SPDX-License-Identifier: Apache-2.0
// The planning problem of a task: its goal in terms of the domain, the world, and excluded actions.
// Pure.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/config/settings/supervisor.hpp"
#include "components/supervisor/situation.hpp"
#include "components/supervisor/task/htn.hpp"
#include "components/supervisor/task/task_planner.hpp"

namespace handsel::supervisor {

/// Computes plans and evaluates actions in the present situation, which must be known.
class PlanningProblem {
 public:
  /// `settings`, `domain` and `situation` must outlive this object.
  PlanningProblem(const settings::SupervisorSettings& settings, const Domain& domain,
                  Situation& situation, const TaskGoal& goal);

  /// Returns the goal of the task.
  const TaskGoal& goal() const { return goal_; }
  /// Returns a phrase for the goal.
  const std::string& text() const { return text_; }
  /// Replaces the goal; does not change the query.
  void set_goal(const TaskGoal& goal);
  /// Returns a goal in terms of the domain and of the present world.
  TaskQuery resolve(const TaskGoal& goal) const;
  /// Returns the planned query.
  const TaskQuery& query() const { return query_; }
  /// Replaces the planned query.
  void set_query(const TaskQuery& query) { query_ = query; }

  /// Returns the plan for the query from this state.
  Plan plan(const State& state) const;
  /// Returns the plan that puts back the held object, at its original place if possible.
  Plan recovery(const State& state) const;
  /// Excludes an action from all plans.
  void forbid(const PlannedAction& action, const std::string& reason);
  /// Permits the placing actions that were excluded because of an unsuitable grasp of the object.
  /// Returns whether this is the first time for the object.
  bool permit_placing(const std::string& object);
  /// Returns whether permit_placing() was called for this object.
  bool has_permitted_placing(const std::string& object) const {
    return permitted_.count(object) > 0;
  }
  /// Stores the present surface of the object as its place for a recovery.
  void note_home(const std::string& object);

  /// Returns why the actions cannot be done one after the other; empty: they can.
  std::string why_impossible(const std::vector<PlannedAction>& actions, State state) const;
  /// Returns the violated condition of the running action; empty: none.
  std::string why_broken(const PlannedAction& action) const;
  /// Returns the state of the world after the action.
  State after(const PlannedAction& action) const;
  /// Returns the violated condition of the finished task in the state; empty: none.
  std::string unachieved(const State& state) const;
  /// Returns why a new plan does not contain an action.
  std::string why_replaced(const PlannedAction& action) const;
  /// Returns why the action is forbidden, else why_replaced().
  std::string why_dropped(const PlannedAction& action) const;

 private:
  Plan plan(int task, const std::vector<std::string>& args, const State& state) const;

  const settings::SupervisorSettings& settings_;
  const Domain& domain_;
  Situation& situation_;
  TaskGoal goal_;
  std::string text_;
  TaskQuery query_;
  Forbidden forbidden_;
  std::map<std::string, std::vector<std::string>> forbidden_places_;  // object: texts of actions
  std::set<std::string> permitted_;                                   // objects
  std::map<std::string, std::string> homes_;  // object: surface it came from
};

}  // namespace handsel::supervisor
