// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/actions/together.hpp"

#include <algorithm>

#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"
#include "components/manipulation_planner/motion/tool_motion.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr std::size_t kTogetherSteps = 3;     // of a plan: two grasps and the release
constexpr double kMaxTogetherDuration = 600;  // of a motion whose end is awaited [s]

/// Closes the hand in use by a grasp.
Routine<Outcome> close_on(Parts& parts, const Grasp& grasp) {
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
Routine<Outcome> take_together(Parts& parts, const std::string& object, const TogetherPlan& plan) {
  const std::vector<const RegraspStep*> steps{&plan.first, &plan.second};
  for (const RegraspStep* step : steps) {
    Outcome done = co_await enclose(parts, object, *step);
    if (!done.good) co_return done;
  }
  for (const RegraspStep* step : steps) {
    Outcome done = co_await use_arm(parts, step->to);
    if (done.good) done = co_await close_on(parts, step->grasp);
    if (!done.good) co_return done;
  }
  co_await parts.waiting.pause(parts.settings.settle_time);
  Outcome done = co_await use_arm(parts, plan.first.to);
  if (!done.good) co_return done;
  const SceneObject* held = parts.now.object(object);
  if (held == nullptr) co_return Outcome::failure("object " + object + " left the scene");
  parts.held.hold(*held);
  parts.held.set_grasp(plan.first.grasp);
  parts.held.join();
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

/// Returns the manipulator of an arm; nullptr: the robot has no such arm.
const Manipulator* manipulator_of(const Parts& parts, const std::string& arm) {
  const auto& all = parts.arm.manipulators();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Manipulator& m) { return m.name == arm; });
  return found == all.end() ? nullptr : &*found;
}

/// Opens a request for the closed chain that moves the object through poses.
TrajectoryRequest chain_request(Parts& parts, const TogetherMotion& motion,
                                const Manipulator& follower) {
  const Vector start = parts.arm.configuration();
  const RobotModel& robot = parts.arm.robot();
  TrajectoryRequest request =
      trajectory_request(parts, parts.clients.trajectory, {}, start, motion.spec);
  // The whole path was checked with the elbow where it is.
  const Pose& T_tool_object = parts.held.attachment().T_tool_object;
  for (const Pose& T : motion.T_world_object)
    request.poses.push_back(tip_node(parts, T * T_tool_object.inverse(), start));
  request.follower = motion.follower;
  request.T_tip_follower =
      robot.link_pose(start, parts.arm.palm()).inverse() * robot.link_pose(start, follower.palm);
  request.upright = true;
  request.upright_axis = T_tool_object.linear() * Vector3::UnitZ();
  request.max_tilt = parts.settings.two_hand_max_tilt;
  return request;
}

/// Runs a command until its motion has ended or must end.
Routine<Outcome> run_watched(Parts& parts, const TrajectoryCommand& command,
                             const TogetherMotion& motion) {
  Outcome sent = co_await parts.link.send(command);
  if (!sent.good) co_return sent;
  const TimePoint began = parts.now.time();
  parts.monitor.restart();
  const std::uint64_t id = command.id;
  const auto must_end = [&] {
    return parts.monitor.must_end(motion.spec, began) || (motion.is_over && motion.is_over());
  };
  const auto is_over = [&] { return parts.link.has_ended(id) || must_end(); };
  co_await parts.waiting.until(is_over, kMaxTogetherDuration);
  if (parts.link.has_ended(id)) {
    Outcome end = co_await parts.link.end_of(id);
    co_return end;
  }
  Outcome why = parts.monitor.why_ended(motion.spec, began);
  if (!parts.monitor.must_end(motion.spec, began)) {
    why = Outcome::failure("what the motion led to was moved away");
    why.end = MotionEnd::target_moved;
  }
  co_await parts.link.stop();
  co_return why;
}

}  // namespace

Routine<TogetherPlan> ask_together(Parts& parts, const std::string& object,
                                   const std::vector<Pose>& goals, HandsUse use) {
  TogetherPlan plan;
  TwoHandPlan found = co_await ask_regrasp(parts, object, goals, use);
  plan.outcome = found.outcome;
  if (!plan.outcome.good) co_return plan;
  if (found.steps.size() != kTogetherSteps) {
    plan.outcome = Outcome::failure("the grasp planner did not say how two hands take " + object);
    co_return plan;
  }
  plan.first = found.steps[0];
  plan.second = found.steps[1];
  plan.down = found.steps[2];
  co_return plan;
}

Routine<Outcome> try_to_take(Parts& parts, const std::string& object, const TogetherPlan& plan) {
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

Routine<Outcome> move_together(Parts& parts, const TogetherMotion& motion) {
  const Manipulator* follower = manipulator_of(parts, motion.follower);
  if (follower == nullptr) co_return Outcome::failure("there is no arm " + motion.follower);
  const bool ready = co_await parts.link.await_permission();
  if (!ready) co_return parts.link.not_permitted();
  auto& timing = parts.clients.trajectory;
  const TrajectoryRequest request = chain_request(parts, motion, *follower);
  const bool answered = co_await timing.ask(request);
  if (!answered) co_return Outcome::no_answer("trajectory");
  if (!timing.reply()->solved)
    co_return Outcome::failure("both hands together: " + timing.reply()->reason);
  TrajectoryCommand command = trajectory_command(parts, timing.reply()->trajectory, motion.spec);
  command.axes = timing.reply()->axes;
  Outcome run;
  if (motion.is_watched)
    run = co_await run_watched(parts, command, motion);
  else
    run = co_await parts.link.run(command);
  co_return run;
}

TogetherMotion together_motion(const Parts& parts, const std::string& object,
                               const TogetherPlan& plan) {
  TogetherMotion motion;
  motion.follower = plan.second.to;
  motion.spec.allowed = {object};
  motion.spec.speed = parts.settings.two_hand_speed;
  return motion;
}

Pose raised(Pose T, double by) {
  T.translation().z() += by;
  return T;
}

Routine<Outcome> release_both(Parts& parts, const std::string& object, const TogetherPlan& plan) {
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

}  // namespace handsel::manipulation_planner
