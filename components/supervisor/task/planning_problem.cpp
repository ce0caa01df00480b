// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/planning_problem.hpp"

#include "components/supervisor/task/action_check.hpp"

namespace handsel::supervisor {

PlanningProblem::PlanningProblem(const settings::SupervisorSettings& settings, const Domain& domain,
                                 Situation& situation, const TaskGoal& goal)
    : settings_(settings),
      domain_(domain),
      situation_(situation),
      goal_(goal),
      text_(text_of(goal_)) {}

void PlanningProblem::set_goal(const TaskGoal& goal) {
  goal_ = goal;
  text_ = text_of(goal_);
}

TaskQuery PlanningProblem::resolve(const TaskGoal& goal) const {
  return query_for(goal, domain_, situation_.world(), situation_.scene());
}

Plan PlanningProblem::plan(int task, const std::vector<std::string>& args,
                           const State& state) const {
  World world = situation_.world();
  world.state = state;
  const PlanLimits limits{settings_.plan_nodes, settings_.plan_depth};
  return make_plan(domain_, world, task, args, forbidden_, limits);
}

Plan PlanningProblem::plan(const State& state) const {
  return plan(query_.task, query_.args, state);
}

Plan PlanningProblem::recovery(const State& state) const {
  const std::string held = situation_.held();
  const auto home = homes_.find(held);
  const int recover = domain_.task("recover");
  if (recover < 0) return {};
  const bool has_home = home != homes_.end() && !home->second.empty();
  return plan(recover, {held.empty() ? "-" : held, has_home ? home->second : "-"}, state);
}

void PlanningProblem::note_home(const std::string& object) {
  if (object.empty()) return;
  const std::string home = situation_.surface_of(object);
  if (!home.empty()) homes_[object] = home;
}

void PlanningProblem::forbid(const PlannedAction& action, const std::string& reason) {
  const std::string text = action.text();
  forbidden_[text] = reason;
  if (action.puts_down()) forbidden_places_[action.object].push_back(text);
}

bool PlanningProblem::permit_placing(const std::string& object) {
  for (const std::string& text : forbidden_places_[object]) forbidden_.erase(text);
  forbidden_places_.erase(object);
  return permitted_.insert(object).second;
}

std::string PlanningProblem::why_impossible(const std::vector<PlannedAction>& actions,
                                            State state) const {
  World& world = situation_.world();
  for (const PlannedAction& action : actions) {
    if (std::string why = why_not(domain_, world, action, state); !why.empty()) return why;
    apply(domain_, world, action, state);
  }
  return "";
}

std::string PlanningProblem::why_broken(const PlannedAction& action) const {
  World& world = situation_.world();
  return broken(domain_, world, action, world.state);
}

State PlanningProblem::after(const PlannedAction& action) const {
  World& world = situation_.world();
  State state = world.state;
  if (!shows(domain_, world, action, state)) apply(domain_, world, action, state);
  return state;
}

std::string PlanningProblem::unachieved(const State& state) const {
  return supervisor::unachieved(domain_, situation_.world(), query_.task, query_.args, state);
}

std::string PlanningProblem::why_replaced(const PlannedAction& action) const {
  const std::string fate = action.object.empty() ? "" : situation_.fate_of(action.object);
  return fate.empty() ? std::string("another method was taken") : fate;
}

std::string PlanningProblem::why_dropped(const PlannedAction& action) const {
  const auto no = forbidden_.find(action.text());
  return no != forbidden_.end() ? no->second : why_replaced(action);
}

}  // namespace handsel::supervisor
