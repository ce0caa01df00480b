#include "components/supervisor/task_planner.hpp"

#include <algorithm>

namespace handsel::supervisor {
namespace {

const Fact* find(const Facts& facts, FactKind kind, const std::string& subject) {
  const auto it =
      std::find_if(facts.facts.begin(), facts.facts.end(), [&](const Fact& f) { return f.kind == kind && f.subject == subject; });
  return it == facts.facts.end() ? nullptr : &*it;
}

// Who to give to when nobody is named: an attentive person, else whoever is near; empty if nobody is.
std::string someone(const Facts& facts) {
  for (const FactKind kind : {FactKind::attentive, FactKind::in_interaction_zone, FactKind::in_social_zone})
    for (const auto& fact : facts.facts)
      if (fact.kind == kind) return fact.subject;
  return "";
}

const PlannedAction kRest{ActionKind::go_to, "", "", ""};

}  // namespace

std::string PlannedAction::text() const {
  std::string out = kind == ActionKind::go_to ? "go to rest" : std::string(name(kind)) + " " + object;
  if (!human.empty()) out += (kind == ActionKind::give ? " to " : " for ") + human;
  if (!surface.empty()) out += " on " + surface;
  return out;
}

TaskPlan plan_task(const TaskGoal& goal, const Facts& facts) {
  TaskPlan plan;
  const bool held = find(facts, FactKind::held_by_robot, goal.object) != nullptr;
  const bool needs_object = goal.kind == TaskKind::give || goal.kind == TaskKind::pick || goal.kind == TaskKind::place;
  if (needs_object && goal.object.empty()) {
    plan.reason = std::string(name(goal.kind)) + " needs the name of an object";
    return plan;
  }
  if (const Fact* other = find(facts, FactKind::held_by_human, goal.object); needs_object && other != nullptr) {
    plan.reason = goal.object + " is already in the hands of " + other->object;
    return plan;
  }
  switch (goal.kind) {
    case TaskKind::give: {
      const std::string human = goal.human.empty() ? someone(facts) : goal.human;
      plan.needs_person = human.empty();
      if (!held) plan.actions.push_back({ActionKind::pick, goal.object, human, ""});
      plan.actions.push_back({ActionKind::give, goal.object, human, ""});
      plan.actions.push_back(kRest);
      break;
    }
    case TaskKind::pick:
      plan.actions.push_back({ActionKind::pick, goal.object, "", ""});
      break;
    case TaskKind::place:
      if (goal.surface.empty()) {
        plan.reason = "place needs the name of a surface";
        return plan;
      }
      if (!held) plan.actions.push_back({ActionKind::pick, goal.object, "", ""});
      plan.actions.push_back({ActionKind::place, goal.object, "", goal.surface});
      plan.actions.push_back(kRest);
      break;
    case TaskKind::go_to:
      plan.actions.push_back(kRest);
      break;
    default:
      plan.reason = std::string("this version plans give, pick, place and goto, not ") + name(goal.kind);
      break;
  }
  return plan;
}

std::vector<PlannedAction> recover(const PlannedAction& failed, bool holding, const std::string& home) {
  std::vector<PlannedAction> out;
  if (holding && !home.empty() && failed.kind != ActionKind::place) out.push_back({ActionKind::place, failed.object, "", home});
  if (failed.kind != ActionKind::go_to) out.push_back(kRest);
  return out;
}

}  // namespace handsel::supervisor
