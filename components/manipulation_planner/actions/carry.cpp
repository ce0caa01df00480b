// SPDX-License-Identifier: Apache-2.0
// The action carry: two hands at once on what is too heavy for one, a closed chain: up, over and
// down, level meanwhile.
#include <algorithm>

#include "common/messages/names.hpp"
#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/actions/two_hands.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"
#include "components/manipulation_planner/motion/tool_motion.hpp"
#include "components/manipulation_planner/placing/place_search.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr std::size_t kSteps = 3;  // of a plan: two grasps and the place

/// The steps of the plan.
struct CarryPlan {
  Outcome outcome;
  RegraspStep first, second, down;
};

/// Asks how two hands take the object, place after place.
Routine<CarryPlan> plan_carry(Parts& parts, const ActionGoal& goal) {
  CarryPlan plan;
  TwoHandPlan found;
  found.outcome = Outcome::failure("there is no free place on a surface called " + goal.surface);
  const std::vector<Pose> places = places_for(parts, goal, *parts.now.object(goal.object));
  for (const Pose& place : places) {
    const std::vector<Pose> this_one{place};
    found = co_await ask_regrasp(parts, goal.object, this_one, true);
    if (found.outcome.good) break;
  }
  plan.outcome = found.outcome;
  if (!plan.outcome.good) co_return plan;
  if (found.steps.size() != kSteps) {
    plan.outcome =
        Outcome::failure("the grasp planner did not say how two hands take " + goal.object);
    co_return plan;
  }
  plan.first = found.steps[0];
  plan.second = found.steps[1];
  plan.down = found.steps[2];
  co_return plan;
}

/// Closes the hand in use by a grasp.
Routine<Outcome> grip(Parts& parts, const Grasp& grasp) {
  parts.action.phase = ActionPhase::grasp;
  const double timeout = 2 * parts.settings.hand_timeout;
  HandResult closed =
      co_await parts.hand.run(HandAction::grasp, grasp.hand_joints, timeout, &grasp.hand_effort,
                              parts.settings.two_hand_mass_fraction);
  if (!closed.outcome.good) co_return closed.outcome;
  if (closed.state != HandState::grasped)
    co_return Outcome::failure("the hand " + parts.arm.fingers().name + " closed on nothing",
                               ActionFailure::nothing_grasped);
  co_return Outcome{};
}

/// Moves one hand, open, about its grasp.
Routine<Outcome> enclose(Parts& parts, const std::string& object, const RegraspStep& step) {
  Outcome done = co_await use_arm(parts, step.to);
  if (!done.good) co_return done;
  std::optional<Grasp> grasp = grasp_now(parts, object, step.grasp);
  const SceneObject* thing = parts.now.object(object);
  const bool as_planned =
      thing != nullptr &&
      (thing->T_world_object.translation() - step.T_world_object.translation()).norm() <
          parts.settings.regrasp_same_place;
  // At the end of a joint's range only the place as it was seen when planning is reached.
  if (!grasp && as_planned) grasp = step.grasp;
  if (!grasp)
    co_return Outcome::failure(step.to + " does not reach " + object + " where it stands now");
  parts.action.phase = ActionPhase::opening_hand;
  HandResult open = co_await parts.hand.run(HandAction::move, grasp->pregrasp_joints,
                                            parts.settings.hand_timeout);
  if (!open.outcome.good) co_return open.outcome;
  MotionSpec approach;
  approach.phase = ActionPhase::approach;
  approach.goals = {grasp->approach_joints};
  done = co_await move(parts, approach);
  if (!done.good) co_return done;
  const MotionSpec reach = reach_along(parts, object, *grasp);
  done = co_await move(parts, reach);
  co_return done;
}

/// Opens both hands about their grasps, then closes one after the other.
Routine<Outcome> take_together(Parts& parts, const std::string& object, const CarryPlan& plan) {
  const std::vector<const RegraspStep*> steps{&plan.first, &plan.second};
  for (const RegraspStep* step : steps) {
    Outcome done = co_await enclose(parts, object, *step);
    if (!done.good) co_return done;
  }
  for (const RegraspStep* step : steps) {
    Outcome done = co_await use_arm(parts, step->to);
    if (done.good) done = co_await grip(parts, step->grasp);
    if (!done.good) co_return done;
  }
  co_await parts.waiting.pause(parts.settings.settle_time);
  Outcome done = co_await use_arm(parts, plan.first.to);
  if (!done.good) co_return done;
  const SceneObject* held = parts.now.object(object);
  if (held == nullptr) co_return Outcome::failure("object " + object + " left the scene");
  parts.held.hold(*held);
  parts.held.set_grasp(plan.first.grasp);
  co_return Outcome{};
}

/// Opens a hand that did not get hold and moves it back to its stand-off.
Routine<Outcome> back_off(Parts& parts, const std::string& object, const RegraspStep& step) {
  Outcome off = co_await use_arm(parts, step.to);
  HandResult opened = co_await parts.hand.run(HandAction::move, step.grasp.pregrasp_joints,
                                              parts.settings.hand_timeout);
  if (off.good && opened.outcome.good) {
    MotionSpec back;
    back.phase = ActionPhase::backing_off;
    back.shape = MotionShape::straight_axes;
    back.goals = {step.grasp.approach_joints};
    back.allowed = {object};
    off = co_await move(parts, back);
  }
  if (!off.good) parts.refuse("backing off", off.reason);
  co_return off;
}

/// Tries to take the object with both hands.
Routine<Outcome> try_to_take(Parts& parts, const std::string& object, const CarryPlan& plan) {
  Outcome done;
  for (std::uint32_t tries = 0; tries < parts.settings.two_hand_attempts; ++tries) {
    done = co_await take_together(parts, object, plan);
    if (done.good) break;
    parts.refuse("grasp with both hands", done.reason);
    co_await back_off(parts, object, plan.second);
    co_await back_off(parts, object, plan.first);
  }
  co_return done;
}

/// Moves the object through poses, the other arm following in a closed chain.
Routine<Outcome> move_together(Parts& parts, const std::string& object, const std::string& follower,
                               const std::vector<Pose>& T_world_object) {
  const auto& all = parts.arm.manipulators();
  const auto other = std::find_if(all.begin(), all.end(),
                                  [&](const Manipulator& m) { return m.name == follower; });
  if (other == all.end()) co_return Outcome::failure("there is no arm " + follower);
  const bool ready = co_await parts.link.await_permission();
  if (!ready) co_return parts.link.not_permitted();
  MotionSpec together;
  together.allowed = {object};
  together.speed = parts.settings.two_hand_speed;
  const Vector start = parts.arm.configuration();
  const RobotModel& robot = parts.arm.robot();
  auto& timing = parts.clients.trajectory;
  TrajectoryRequest request = trajectory_request(parts, timing, {}, start, together);
  // The whole path was checked with the elbow where it is.
  const Pose& T_tool_object = parts.held.attachment().T_tool_object;
  for (const Pose& T : T_world_object)
    request.poses.push_back(tip_node(parts, T * T_tool_object.inverse(), start));
  request.follower = follower;
  request.T_tip_follower =
      robot.link_pose(start, parts.arm.palm()).inverse() * robot.link_pose(start, other->palm);
  request.upright = true;
  request.upright_axis = T_tool_object.linear() * Vector3::UnitZ();
  request.max_tilt = parts.settings.two_hand_max_tilt;
  const bool answered = co_await timing.ask(request);
  if (!answered) co_return Outcome::no_answer("trajectory");
  if (!timing.reply()->solved)
    co_return Outcome::failure("both hands together: " + timing.reply()->reason);
  TrajectoryCommand command = trajectory_command(parts, timing.reply()->trajectory, together);
  command.axes = timing.reply()->axes;
  Outcome run = co_await parts.link.run(command);
  co_return run;
}

Pose raised(Pose T, double by) {
  T.translation().z() += by;
  return T;
}

/// Lifts the object, carries it over its place and lowers it. Where it cannot move up or over it is
/// put back; hands that cannot bring it down keep it. `is_down`: whether the hands may open.
Routine<Outcome> lift_over_and_down(Parts& parts, const std::string& object, const CarryPlan& plan,
                                    bool& is_down) {
  const std::string& follower = plan.second.to;
  parts.action.phase = ActionPhase::lift;
  const double height = parts.settings.lift_height;
  const Pose T_start = parts.now.object(object)->T_world_object;
  std::vector<Pose> up{raised(T_start, height)};
  Outcome done = co_await move_together(parts, object, follower, up);
  if (done.good) {
    parts.action.phase = ActionPhase::carry;
    const Pose& T_goal = plan.down.T_world_object;
    std::vector<Pose> over{raised(T_goal, height), raised(T_goal, kAbovePlace)};
    done = co_await move_together(parts, object, follower, over);
  }
  is_down = true;
  const SceneObject* now = parts.now.object(object);
  const bool is_lifted =
      now == nullptr || now->T_world_object.translation().z() >
                            T_start.translation().z() + parts.settings.regrasp_same_place;
  if (!done.good && is_lifted) {
    parts.refuse(text_of(parts.action.phase), done.reason);
    parts.action.phase = ActionPhase::put_back;
    std::vector<Pose> back{raised(T_start, kAbovePlace)};
    Outcome lowered = co_await move_together(parts, object, follower, back);
    is_down = lowered.good;
    if (!lowered.good) co_return lowered;
  }
  co_return done;
}

/// Opens both hands and moves them off as they came: each hand's stand-off from its grasp is the
/// same wherever the object was put down.
Routine<Outcome> release_both(Parts& parts, const std::string& object, const CarryPlan& plan) {
  const std::vector<std::string> arms{plan.first.to, plan.second.to};
  for (const std::string& arm : arms) {
    Outcome done = co_await use_arm(parts, arm);
    if (!done.good) co_return done;
    parts.action.phase = ActionPhase::release;
    const Vector open = RobotModel::part(plan.down.after, parts.arm.fingers());
    HandResult opened =
        co_await parts.hand.run(HandAction::release, open, parts.settings.hand_timeout);
    if (!opened.outcome.good) co_return opened.outcome;
  }
  parts.held.release();
  for (const std::string& arm : arms) {
    Outcome done = co_await use_arm(parts, arm);
    if (done.good) done = co_await release_and_retreat(parts, object, plan.down.q, plan.down.after);
    if (!done.good) co_return done;
  }
  co_return Outcome{};
}

}  // namespace

Routine<Outcome> carry(Parts& parts, const ActionGoal& goal) {
  const std::string object = goal.object;
  Outcome ready = co_await await_put_down(parts, object);
  if (!ready.good) co_return ready;
  Outcome rested = co_await rest_all(parts);
  if (!rested.good) co_return rested;
  const CarryPlan plan = co_await plan_carry(parts, goal);
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
