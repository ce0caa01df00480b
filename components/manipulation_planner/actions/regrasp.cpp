// SPDX-License-Identifier: Apache-2.0
// The action regrasp: from one hand to the other, where one alone cannot bring the object to its
// place (chapter section 3.2.10).
#include <algorithm>

#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/actions/place.hpp"
#include "components/manipulation_planner/actions/rest.hpp"
#include "components/manipulation_planner/actions/two_hands.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"
#include "components/manipulation_planner/placing/destination_search.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kAsideDistances[] = {0.15, 0.25,
                                      0.35};             // of what an arm draws to its own side [m]
constexpr double kMeetingOffsets[] = {0.0, 0.02, 0.04};  // of the place where the hands meet [m]
constexpr double kAboveRatios[] = {1.0, 0.75};           // of the lift height

/// Moves to what the other hand holds and closes on it; where that does not hold, the hand opens
/// again and moves off.
Routine<Outcome> take_over(Parts& parts, const std::string& object, const Grasp& grasp) {
  parts.action.phase = ActionPhase::opening_other_hand;
  const double timeout = parts.settings.hand_timeout;
  HandResult open = co_await parts.hand.run(HandAction::move, grasp.pregrasp_joints, timeout);
  if (!open.outcome.good) co_return open.outcome;
  MotionSpec approach;
  approach.phase = ActionPhase::approach_other_hand;
  approach.goals = {grasp.approach_joints};
  Outcome done = co_await move(parts, approach);
  if (!done.good) co_return done;
  const MotionSpec reach = reach_along(parts, object, grasp);
  done = co_await move(parts, reach);
  if (!done.good) co_return done;
  parts.action.phase = ActionPhase::grasp;
  HandResult closed =
      co_await parts.hand.run(HandAction::grasp, grasp.hand_joints, timeout, &grasp.hand_effort);
  if (closed.outcome.good && closed.state == HandState::grasped) co_return Outcome{};
  co_await parts.hand.run(HandAction::move, grasp.pregrasp_joints, timeout);
  MotionSpec back = reach;
  back.phase = ActionPhase::backing_off;
  back.goals = {grasp.approach_joints};
  co_await move(parts, back);
  if (!closed.outcome.good) co_return closed.outcome;
  co_return Outcome::failure("the other hand closed on nothing", ActionFailure::nothing_grasped);
}

/// Draws what the arm in use holds to its own side, so that the others can move to rest.
Routine<Outcome> draw_aside(Parts& parts) {
  Outcome rested = co_await rest_others(parts);
  if (rested.good) co_return rested;
  const Pose T_now = parts.arm.T_world_tool();
  const Pose T_platform = T_world_platform(parts.now);
  const Eigen::Matrix3d base = T_platform.linear();
  const double side =
      base.col(1).dot(parts.arm.p_world_shoulder() - T_platform.translation()) < 0 ? -1 : 1;
  const std::vector<Vector3> directions{{0, 1, 0.3}, {0, 1, 0},    {0.5, 1, 0},  {-0.5, 1, 0},
                                        {0, 0.3, 1}, {0, 1, -0.5}, {0.7, 0, 0.7}};
  for (const Vector3& direction : directions) {
    std::optional<Vector> farthest;
    for (const double distance : kAsideDistances) {
      Pose T = T_now;
      T.translation() +=
          distance * (base * Vector3(direction.x(), side * direction.y(), direction.z()));
      if (auto joints = parts.arm.reach(T)) farthest = std::move(joints);
    }
    if (!farthest) continue;
    MotionSpec aside;
    aside.phase = ActionPhase::clear_offer_area;
    aside.goals = {*farthest};
    aside.speed = parts.settings.carry_speed;
    Outcome drawn = co_await move(parts, aside);
    if (!drawn.good) continue;
    rested = co_await rest_others(parts);
    if (rested.good) co_return rested;
  }
  co_return rested;
}

/// Returns where the arm in use brings what it holds to the other hand. The object does not lie in
/// the hand quite as planned: it is the object that moves to its place, or to near that where both
/// arms reach it.
std::optional<Vector> meeting_configuration(const Parts& parts, const RegraspStep& step) {
  const auto& all = parts.arm.manipulators();
  const auto taker =
      std::find_if(all.begin(), all.end(), [&](const Manipulator& m) { return m.name == step.to; });
  if (taker == all.end() || taker->arm == nullptr) return std::nullopt;
  const RobotModel& robot = parts.arm.robot();
  const Pose T_base_world = parts.now.T_world_base().inverse();
  const Pose T_grasp_standoff =
      robot.link_pose(step.q, taker->palm).inverse() * robot.link_pose(step.before, taker->palm);
  IkOptions near_by;
  near_by.restarts = 0;
  for (const double off : kMeetingOffsets) {
    for (const Vector3& direction : {Vector3(0, 0, -1), Vector3(-1, 0, 0), Vector3(0, 0, 1),
                                     Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, -1, 0)}) {
      Pose T_base_object = T_base_world * step.T_world_object;
      T_base_object.translation() += off * direction;
      const Pose T_base_tool = T_base_object * parts.held.attachment().T_tool_object.inverse();
      auto own = robot.inverse(parts.arm.group(), T_base_tool, step.q, near_by);
      const Pose T_base_hand = T_base_object * step.grasp.T_object_hand;
      const bool both =
          own && robot.inverse(*taker->arm, T_base_hand, step.q, near_by) &&
          robot.inverse(*taker->arm, T_base_hand * T_grasp_standoff, step.before, near_by);
      if (both) return own;
      if (off == 0) break;
    }
  }
  return std::nullopt;
}

/// How a step of a plan ended.
struct StepResult {
  Outcome outcome;
  bool holds_as_before{};  ///< after a failure: the hand that held the object still does, alone
};

/// Brings what the arm in use holds to where the other one reaches it; that one is in use then, and
/// `grasp` is how it takes the object.
Routine<Outcome> meet(Parts& parts, const std::string& object, const RegraspStep& step,
                      std::optional<Grasp>& grasp) {
  // On the way the object may have turned in the hand.
  const SceneObject* held = parts.now.object(object);
  if (held == nullptr) co_return Outcome::out_of_sight(object);
  parts.held.hold(*held);
  const std::optional<Vector> meeting = meeting_configuration(parts, step);
  if (!meeting)
    co_return Outcome::failure("the arms do not reach the place where " + object +
                               " is to change hands");
  MotionSpec bring;
  bring.phase = ActionPhase::carry_to_other_hand;
  bring.goals = {*meeting};
  bring.speed = parts.settings.carry_speed;
  Outcome done = co_await move(parts, bring);
  if (done.good) done = co_await use_arm(parts, step.to);
  if (!done.good) co_return done;
  grasp = grasp_now(parts, object, step.grasp);
  if (!grasp)
    done = Outcome::failure("the other arm does not reach " + object + " where the first holds it");
  co_return done;
}

/// Brings what one hand holds to the other one and closes that hand on the object as well; `grasp`
/// is how.
Routine<Outcome> join_hands(Parts& parts, const std::string& object, const RegraspStep& step,
                            std::optional<Grasp>& grasp) {
  Outcome done = co_await meet(parts, object, step, grasp);
  for (std::uint32_t tries = 0; grasp && tries < parts.settings.close_attempts; ++tries) {
    done = co_await take_over(parts, object, *grasp);
    if (done.good) co_return done;
    parts.refuse("grasp by the other hand", done.reason);
    grasp = grasp_now(parts, object, step.grasp);
  }
  co_return done;
}

/// Releases with the hand that held the object first; `grasp` is that of the other one.
Routine<Outcome> leave_to_other_hand(Parts& parts, const std::string& object,
                                     const RegraspStep& step, const std::optional<Grasp>& grasp) {
  const double settle_time = parts.settings.settle_time;
  co_await parts.waiting.pause(settle_time);
  const SceneObject* held = parts.now.object(object);
  if (held == nullptr) co_return Outcome::failure("object " + object + " left the scene");
  parts.held.hold(*held);

  Outcome done = co_await use_arm(parts, step.from);
  if (!done.good) co_return done;
  parts.action.phase = ActionPhase::release_first_hand;
  done = co_await release_and_retreat(parts, object, step.q, step.after);
  if (!done.good) co_return done;
  done = co_await use_arm(parts, step.to);
  if (!done.good) co_return done;
  parts.held.set_grasp(grasp);
  const bool taken =
      co_await parts.waiting.until([&] { return parts.held.is_held_by_hand(object); }, settle_time);
  if (!taken) {
    parts.held.release();
    co_return Outcome::failure("the other hand does not feel the load of " + object);
  }
  parts.held.hold(*parts.now.object(object));
  co_return Outcome{};
}

/// Passes what one hand holds to the other one; before the other hand has closed on the object, the
/// arm that holds the object is in use again after a failure.
Routine<StepResult> pass(Parts& parts, const std::string& object, const RegraspStep& step) {
  const std::optional<Grasp> before = parts.held.grasp();
  StepResult result;
  std::optional<Grasp> grasp;
  result.outcome = co_await join_hands(parts, object, step, grasp);
  if (result.outcome.good) {
    result.outcome = co_await leave_to_other_hand(parts, object, step, grasp);
    co_return result;
  }
  Outcome back = co_await use_arm(parts, step.from);
  if (back.good && parts.held.is_held_by_hand(object)) {
    parts.held.set_grasp(before);
    result.holds_as_before = true;
  }
  co_return result;
}

/// Puts what is held down where the step says.
Routine<Outcome> put_down(Parts& parts, const std::string& object, const RegraspStep& step) {
  if (!parts.held.is_held_by_hand(object))
    co_return Outcome::failure("the hand does not hold " + object);
  const RobotModel& robot = parts.arm.robot();
  const Group& arm = parts.arm.group();
  const Pose T_base_world = parts.now.T_world_base().inverse();
  const Pose T_object_tool = parts.held.attachment().T_tool_object.inverse();
  IkOptions options;
  options.restarts = 2;
  Pose T_world_object = step.T_world_object;
  T_world_object.translation().z() += kAbovePlace;
  const auto at =
      robot.inverse(arm, T_base_world * T_world_object * T_object_tool, step.q, options);
  if (!at)
    co_return Outcome::failure("the arm does not reach the place where " + object + " is to stand");
  std::optional<Vector> above;
  for (const double ratio : kAboveRatios) {
    Pose T_above = T_world_object;
    T_above.translation().z() += ratio * parts.settings.lift_height;
    const Vector near = RobotModel::with(step.q, arm, *at);
    if (!above) above = robot.inverse(arm, T_base_world * T_above * T_object_tool, near, options);
  }
  if (!above)
    co_return Outcome::failure("the arm does not reach above the place where " + object +
                               " is to stand");
  std::vector<PlacingConfiguration> places(1);
  PlacingConfiguration& configuration = places.front();
  configuration.T_world_object = T_world_object;
  configuration.arm_above = *above;
  configuration.arm_at = *at;
  Outcome down = co_await lower(parts, places);
  if (!down.good) co_return down;
  down = co_await release_and_retreat(parts, object, step.q, step.after);
  co_return down;
}

/// Puts what is held down; the hand that passed the object on may be in the way.
Routine<Outcome> put_down_or_clear(Parts& parts, const std::string& object,
                                   const RegraspStep& step) {
  Outcome done = co_await put_down(parts, object, step);
  if (!done.good && parts.held.is_held_by_hand(object)) {
    parts.refuse("put down", done.reason);
    done = co_await draw_aside(parts);
    if (done.good) done = co_await put_down(parts, object, step);
  }
  co_return done;
}

/// Executes one step of a plan. `is_first_pass`: nothing has to be drawn aside.
Routine<StepResult> execute_step(Parts& parts, const std::string& object, const RegraspStep& step,
                                 bool is_first_pass) {
  StepResult result;
  Outcome& done = result.outcome;
  done = co_await use_arm(parts, step.kind == RegraspKind::pick ? step.to : step.from);
  if (!done.good) co_return result;
  switch (step.kind) {
    case RegraspKind::pick:
      done = co_await try_grasp(parts, object, "", step.grasp);
      break;
    case RegraspKind::pass:
      if (!is_first_pass) done = co_await draw_aside(parts);
      if (!done.good) parts.refuse("clearing the offer area", done.reason);
      result = co_await pass(parts, object, step);
      break;
    case RegraspKind::place:
      done = co_await put_down_or_clear(parts, object, step);
      result.holds_as_before = parts.held.is_held_by_hand(object);
      break;
    case RegraspKind::join:
      done = Outcome::failure("two hands at once were not asked for");
      break;
  }
  co_return result;
}

/// Returns places on a surface that an arm which is not in use reaches; with none of these, places
/// that the arm in use reaches, where it needs another grasp; empty: none.
Routine<std::vector<Pose>> places_for_held(Parts& parts, const std::string& onto) {
  const SceneBox* seen = parts.now.surface(onto);
  std::vector<Pose> places;
  if (seen == nullptr) co_return places;
  const SceneBox surface = *seen;
  const std::string in_use = parts.arm.group().name, object = parts.held.id();
  const Pose T_world_object = parts.held.T_world_object();
  std::vector<std::string> arms;
  for (const Manipulator& other : parts.arm.manipulators())
    if (other.arm != nullptr && other.name != in_use) arms.push_back(other.name);
  arms.push_back(in_use);
  for (const std::string& arm : arms) {
    places = co_await find_standing_places(parts, surface, arm, object, T_world_object);
    if (!places.empty()) break;
  }
  co_return places;
}

/// Returns where the object may be put: on the surface or at the place of the goal.
Routine<std::vector<Pose>> places_of(Parts& parts, const ActionGoal& goal, bool is_held) {
  std::vector<Pose> places;
  if (is_held && !goal.has_goal) {
    places = co_await places_for_held(parts, goal.surface);
    co_return places;
  }
  const SceneObject* seen = parts.now.object(goal.object);
  if (seen != nullptr) places = places_for(parts, goal, *seen);
  co_return places;
}

/// Plans once, from where the object is now, and executes that plan.
Routine<StepResult> execute_plan(Parts& parts, const ActionGoal& goal) {
  const std::string object = goal.object;
  const bool is_held = parts.held.is_holding() && parts.held.id() == object;
  StepResult result;
  const std::vector<Pose> places = co_await places_of(parts, goal, is_held);
  if (places.empty()) {
    result.outcome = Outcome::failure(
        goal.surface.empty() ? "it was not said where " + object + " is to stand"
                             : "there is no free place on a surface called " + goal.surface);
    co_return result;
  }
  TwoHandPlan plan = co_await ask_regrasp(parts, object, places, HandsUse::in_turn);
  result.outcome = plan.outcome;
  if (!plan.outcome.good) co_return result;
  // Where the steps begin.
  if (is_held)
    result.outcome = co_await rest_others(parts);
  else
    result.outcome = co_await rest_all(parts);
  const std::size_t first_pass = is_held ? 0 : 1;
  for (std::size_t i = 0; result.outcome.good && i < plan.steps.size(); ++i)
    result = co_await execute_step(parts, object, plan.steps[i], i == first_pass);
  co_return result;
}

}  // namespace

Routine<Outcome> regrasp(Parts& parts, const ActionGoal& goal) {
  const std::string object = goal.object;
  const bool is_held = parts.held.is_holding() && parts.held.id() == object;
  if (!is_held) {
    Outcome ready = co_await await_put_down(parts, object);
    if (!ready.good) co_return ready;
  }
  if (parts.now.object(object) == nullptr) co_return Outcome::out_of_sight(object);
  if (parts.now.model_of(object) == nullptr)
    co_return Outcome::failure("object " + object + " has no model");
  StepResult result;
  for (std::uint32_t attempts = 1;; ++attempts) {
    result = co_await execute_plan(parts, goal);
    // The object does not lie in the hand as planned: what is next is planned from how it does.
    const bool again =
        !result.outcome.good && result.holds_as_before && attempts < parts.settings.motion_attempts;
    if (!again) break;
    parts.refuse("regrasp", result.outcome.reason);
  }
  if (!result.outcome.good) co_return result.outcome;
  Outcome rested = co_await rest_all(parts);
  if (!rested.good) parts.refuse("to rest", rested.reason);
  co_return Outcome{};
}

}  // namespace handsel::manipulation_planner
