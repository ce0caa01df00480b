// What a task asks of the planner: its goal in terms of the domain, the world, and the actions that
// must not be tried again. Pure.
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

/// Asks the planner for plans, and evaluates actions, in the present situation. The functions need
/// a known situation.
class PlanningProblem {
 public:
  /// `settings`, `domain` and `situation` must outlive this object.
  PlanningProblem(const settings::SupervisorSettings& settings, const Domain& domain,
                  Situation& situation, const TaskGoal& goal);

  /// Goal of the task.
  const TaskGoal& goal() const { return goal_; }
  /// Phrase for the goal, for people.
  const std::string& text() const { return text_; }
  /// Replaces the goal; the query stays.
  void set_goal(const TaskGoal& goal);
  /// Returns a goal in terms of the domain and of the present world.
  TaskQuery resolve(const TaskGoal& goal) const;
  /// The query that is planned for.
  const TaskQuery& query() const { return query_; }
  /// Replaces the query that is planned for.
  void set_query(const TaskQuery& query) { query_ = query; }

  /// Returns the plan for the query from this state.
  Plan plan(const State& state) const;
  /// Returns the plan that puts back what the robot holds, where it came from if possible.
  Plan recovery(const State& state) const;
  /// Excludes an action from all plans.
  void forbid(const PlannedAction& action, const std::string& reason);
  /// Admits the placing actions that were excluded since the robot's hold of the object did not
  /// serve for them. Returns whether this is the first time for the object.
  bool permit_placing(const std::string& object);
  /// Returns whether permit_placing() was called for this object.
  bool has_permitted_placing(const std::string& object) const {
    return permitted_.count(object) > 0;
  }
  /// Remembers the surface on which the object is now, as its place for a recovery.
  void note_home(const std::string& object);

  /// Returns why the actions cannot be done one after the other; empty: they can.
  std::string why_impossible(const std::vector<PlannedAction>& actions, State state) const;
  /// Returns which condition does not hold that must hold while the action runs; empty: all do.
  std::string why_broken(const PlannedAction& action) const;
  /// Returns the state of the world after the action.
  State after(const PlannedAction& action) const;
  /// Returns which condition of the finished task does not hold in the state; empty: all do.
  std::string unachieved(const State& state) const;
  /// Returns why a new plan does without an action, for people.
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
