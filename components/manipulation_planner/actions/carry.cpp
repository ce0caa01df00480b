// SPDX-License-Identifier: Apache-2.0
// The action carry: two hands at once on what is too heavy for one, a closed chain: up, over and
// down, level meanwhile.
#include "common/messages/names.hpp"
#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/together.hpp"
#include "components/manipulation_planner/placing/place_search.hpp"

namespace handsel::manipulation_planner {
namespace {

/// Asks how two hands take the object, place after place.
Routine<TogetherPlan> plan_carry(Parts& parts, const ActionGoal& goal) {
  TogetherPlan plan;
  plan.outcome = Outcome::failure("there is no free place on a surface called " + goal.surface);
  const std::vector<Pose> places = places_for(parts, goal, *parts.now.object(goal.object));
  for (const Pose& place : places) {
    const std::vector<Pose> this_one{place};
    plan = co_await ask_together(parts, goal.object, this_one, HandsUse::together);
    if (plan.outcome.good) break;
  }
  co_return plan;
}

/// Lifts the object, carries it over its place and lowers it. Where it cannot move up or over it is
/// put back; hands that cannot bring it down keep it. `is_down`: whether the hands may open.
Routine<Outcome> lift_over_and_down(Parts& parts, const std::string& object,
                                    const TogetherPlan& plan, bool& is_down) {
  TogetherMotion motion = together_motion(parts, object, plan);
  parts.action.phase = ActionPhase::lift;
  const double height = parts.settings.lift_height;
  const Pose T_start = parts.now.object(object)->T_world_object;
  motion.T_world_object = {raised(T_start, height)};
  Outcome done = co_await move_together(parts, motion);
  if (done.good) {
    parts.action.phase = ActionPhase::carry;
    const Pose& T_goal = plan.down.T_world_object;
    motion.T_world_object = {raised(T_goal, height), raised(T_goal, kAbovePlace)};
    done = co_await move_together(parts, motion);
  }
  is_down = true;
  const SceneObject* now = parts.now.object(object);
  const bool is_lifted =
      now == nullptr || now->T_world_object.translation().z() >
                            T_start.translation().z() + parts.settings.regrasp_same_place;
  if (!done.good && is_lifted) {
    parts.refuse(text_of(parts.action.phase), done.reason);
    parts.action.phase = ActionPhase::put_back;
    motion.T_world_object = {raised(T_start, kAbovePlace)};
    Outcome lowered = co_await move_together(parts, motion);
    is_down = lowered.good;
    if (!lowered.good) co_return lowered;
  }
  co_return done;
}

}  // namespace

Routine<Outcome> carry(Parts& parts, const ActionGoal& goal) {
  const std::string object = goal.object;
  Outcome ready = co_await await_put_down(parts, object);
  if (!ready.good) co_return ready;
  Outcome rested = co_await rest_all(parts);
  if (!rested.good) co_return rested;
  const TogetherPlan plan = co_await plan_carry(parts, goal);
  if (!plan.outcome.good) co_return plan.outcome;
  Outcome done = co_await try_to_take(parts, object, plan);
  if (!done.good) co_return done;
  done = co_await use_arm(parts, plan.first.to);
  if (!done.good) co_return done;
  bool is_down = false;
  const Outcome carried = co_await lift_over_and_down(parts, object, plan, is_down);
  if (!is_down) co_return carried;
  done = co_await release_both(parts, object, plan);
  if (!done.good) co_return done;
  done = co_await rest_all(parts);
  if (!done.good) parts.refuse("to rest", done.reason);
  co_return carried;
}

}  // namespace handsel::manipulation_planner
