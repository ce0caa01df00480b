// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/regrasp/sequence_search.hpp"

#include <algorithm>

namespace handsel::grasp_planner {

SequenceSearch::SequenceSearch(StepCheck& check, CheckedPasses& passes, const RegraspTask& task)
    : check_(check),
      passes_(passes),
      task_(task),
      start_{task.start.arm, task.start.grasp.value_or(0)},
      graph_(check.settings().costs) {
  check_task();
  add_places();
  add_grasps();
}

void SequenceSearch::check_task() const {
  const int count = static_cast<int>(check_.arms().size());
  for (const ObjectState* state : {&task_.start, &task_.goal}) {
    if (state->arm >= count)
      throw ConfigError("arm " + std::to_string(state->arm) + " is asked for; there are " +
                        std::to_string(count));
    if (state->arm < 0 || !state->grasp) continue;
    const std::size_t listed =
        check_.arms()[static_cast<std::size_t>(state->arm)].list->grasps.size();
    if (*state->grasp >= listed) {
      throw ConfigError("grasp " + std::to_string(*state->grasp) + " is asked for; the list has " +
                        std::to_string(listed));
    }
  }
  if (task_.start.arm >= 0 && !task_.start.grasp)
    throw ConfigError("the start says which hand holds the object but not with which grasp");
}

void SequenceSearch::add_places() {
  if (task_.start.arm < 0) {
    start_ = {-1, places_.size()};
    places_.push_back(task_.start.T_world_object);
  }
  if (task_.goal.arm < 0) {
    goals_.first = places_.size();
    places_.push_back(task_.goal.T_world_object);
    places_.insert(places_.end(), task_.other_goals.begin(), task_.other_goals.end());
    goals_.end = places_.size();
  }
  places_.insert(places_.end(), task_.placements.begin(), task_.placements.end());
}

/// Adds picking and placing with the grasps of each arm that may be used. There may be many places
/// to put the object down: those that the arm reaches most easily are checked first.
void SequenceSearch::add_grasps() {
  for (int a = 0; a < static_cast<int>(check_.arms().size()); ++a) {
    const RegraspArm& arm = check_.arms()[static_cast<std::size_t>(a)];
    HandSide side{arm.hand_geometry, arm.list, {}, {}};
    for (const ObjectState* state : {&task_.start, &task_.goal})
      if (state->arm == a && state->grasp) side.also.push_back(*state->grasp);
    const std::vector<std::size_t> taken =
        taken_grasps(*arm.list, check_.settings().max_of_each, Taken::spread,
                     check_.object().box().center(), side.also);
    sides_.push_back(std::move(side));
    for (const std::size_t i : taken) {
      for (std::size_t p = 0; p < places_.size(); ++p) {
        const Grasp& g = check_.grasp(a, i);
        const std::optional<double> strain = check_.strain(a, i, places_[p]);
        if (!strain) {
          ++rejected_["grasps at a place: no configuration of the arm reaches it"];
          continue;
        }
        graph_.add({-1, p}, {a, i}, g.quality, g.margin);
        graph_.add({a, i}, {-1, p}, g.quality, g.margin, *strain);
      }
    }
  }
}

/// Adds passes with the pairs of grasps that do not collide.
void SequenceSearch::add_passes(const std::function<bool()>& cancelled) {
  DoubleSettings pairs;
  pairs.max_of_each = check_.settings().max_of_each;
  pairs.taken = Taken::spread;
  pairs.p_object_middle = check_.object().box().center();
  pairs.clearance = check_.settings().clearance;
  pairs.passed = &check_.object();
  pairs.stand_off = check_.settings().stand_off;
  doubles_ = list_double_grasps(sides_[0], sides_[1], pairs, cancelled);
  out_.double_grasps = doubles_.grasps.size();
  for (std::size_t n = 0; n < doubles_.grasps.size(); ++n) {
    const DoubleGrasp& d = doubles_.grasps[n];
    const double margin =
        std::min(check_.grasp(0, d.first).margin, check_.grasp(1, d.second).margin);
    graph_.add({0, d.first}, {1, d.second}, d.quality, margin, 0.0, n);
    graph_.add({1, d.second}, {0, d.first}, d.quality, margin, 0.0, n);
  }
}

bool SequenceSearch::at_goal(const GraphNode& node) const {
  if (task_.goal.arm < 0)
    return node.arm < 0 && node.index >= goals_.first && node.index < goals_.end;
  return node.arm == task_.goal.arm && (!task_.goal.grasp || node.index == *task_.goal.grasp);
}

const CheckedStep& SequenceSearch::pick(const GraphNode& held, std::size_t place) {
  const auto [it, fresh] = picks_.try_emplace({held.arm, held.index, place});
  if (fresh) {
    ++out_.checked;
    it->second = check_.check_pick(held.arm, held.index, places_[place]);
  }
  return it->second;
}

CheckedStep SequenceSearch::pass(const GraphNode& from, const GraphNode& to) {
  const auto [it, fresh] = passes_.try_emplace({from.arm, from.index, to.arm, to.index});
  if (fresh) {
    ++out_.checked;
    const DoubleGrasp& d = doubles_.grasps[graph_.pair(from, to)];
    const bool straight = from.arm == 0;
    it->second = check_.check_pass({from.arm, to.arm, from.index, to.index,
                                    straight ? d.retreat_first : d.retreat_second,
                                    straight ? d.retreat_second : d.retreat_first});
  }
  CheckedStep checked = it->second;
  if (!checked.step) return checked;
  checked.step->kind = RegraspStepKind::pass;
  checked.step->from = from.arm;
  checked.step->grasp_from = from.index;
  checked.step->to = to.arm;
  checked.step->grasp_to = to.index;
  return checked;
}

CheckedStep SequenceSearch::step(const GraphNode& from, const GraphNode& to) {
  if (from.arm >= 0 && to.arm >= 0) return pass(from, to);
  const bool picking = from.arm < 0;
  CheckedStep checked = picking ? pick(to, from.index) : pick(from, to.index);
  if (!checked.step) return checked;
  checked.step->kind = picking ? RegraspStepKind::pick : RegraspStepKind::place;
  (picking ? checked.step->to : checked.step->from) = picking ? to.arm : from.arm;
  (picking ? checked.step->grasp_to : checked.step->grasp_from) = picking ? to.index : from.index;
  (picking ? checked.step->after : checked.step->before).resize(0);
  return checked;
}

/// Writes the steps of the path to the plan. Returns false at a step that cannot be made, which
/// leaves the graph.
bool SequenceSearch::take_path(const std::vector<GraphNode>& path) {
  out_.steps.clear();
  for (std::size_t n = 0; n + 1 < path.size(); ++n) {
    CheckedStep checked = step(path[n], path[n + 1]);
    if (checked.step) {
      out_.steps.push_back(std::move(*checked.step));
      continue;
    }
    const bool passing = path[n].arm >= 0 && path[n + 1].arm >= 0;
    ++rejected_[(passing ? "passes: " : path[n].arm < 0 ? "picks: " : "places: ") + checked.reason];
    graph_.remove(path[n], path[n + 1]);
    out_.steps.clear();
    return false;
  }
  return true;
}

RegraspPlan SequenceSearch::finish() {
  for (const auto& [what, times] : rejected_) {
    const auto colon = what.find(": ");
    out_.rejected.push_back(
        {std::to_string(times) + " " + what.substr(0, colon), what.substr(colon + 2)});
  }
  return std::move(out_);
}

RegraspPlan SequenceSearch::run(const std::function<bool()>& cancelled) {
  if (check_.arms().size() == 2) add_passes(cancelled);
  while (true) {
    const std::vector<GraphNode> path =
        graph_.shortest(start_, [this](const GraphNode& node) { return at_goal(node); });
    if (path.empty()) {
      const auto most =
          std::max_element(rejected_.begin(), rejected_.end(),
                           [](const auto& x, const auto& y) { return x.second < y.second; });
      out_.reason = "no sequence of grasps leads there";
      if (most != rejected_.end())
        out_.reason += "; most often: " + std::to_string(most->second) + " " + most->first;
      return finish();
    }
    if (take_path(path)) {
      out_.solved = true;
      return finish();
    }
    if (out_.checked >= check_.settings().max_steps_tried || (cancelled && cancelled())) {
      out_.reason = cancelled && cancelled() ? "cancelled"
                                             : "the budget of " + std::to_string(out_.checked) +
                                                   " checked steps was used up";
      return finish();
    }
  }
}

}  // namespace handsel::grasp_planner
