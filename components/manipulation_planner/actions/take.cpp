// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/actions/take.hpp"

#include <algorithm>

#include "components/manipulation_planner/actions/giver_hand.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"

namespace handsel::manipulation_planner {
namespace {

/// How far an attempt has come.
enum class Progress : std::uint8_t {
  failed,       ///< another grasp or offer is needed
  again,        ///< the object is elsewhere: the hand follows
  at_standoff,  ///< the straight motion in can begin
  in_hand,      ///< the fingers can close
};
struct Step {
  Progress progress{};
  Outcome outcome;
};

bool is_offered(const Parts& parts, const Offer& offer) {
  const Vector3 p_hand = parts.arm.T_world_tool().translation();
  return parts.offers.find(offer.object, offer.giver, p_hand).has_value();
}

/// Returns whether an eager giver has put the object into the open hand.
bool is_put_into_hand(const Parts& parts, const TakeAttempt& take) {
  const SceneObject* given = parts.now.object(take.offer.object);
  if (given == nullptr || given->holder != Holder::robot) return false;
  const Vector3 p_tool_object =
      parts.arm.T_world_tool().inverse() * given->T_world_object.translation();
  return (p_tool_object - take.chosen.T_object_hand.inverse().translation()).norm() <
         parts.settings.max_in_hand_error;
}

/// Returns whether the hand is so near to the object that it must not open or turn beside it.
bool is_near_object(const Parts& parts, const std::string& object) {
  const SceneObject* seen = parts.now.object(object);
  const Vector3 p_hand = parts.arm.T_world_tool().translation();
  return seen != nullptr &&
         (seen->T_world_object.translation() - p_hand).norm() < parts.settings.beside_range;
}

/// Returns whether an object is where it was before the hand came: the hand had pushed it.
bool is_at(const Parts& parts, const std::string& object, const Vector3& p_world) {
  const SceneObject* seen = parts.now.object(object);
  return seen != nullptr &&
         (seen->T_world_object.translation() - p_world).norm() < parts.settings.aim_slack / 2;
}

Outcome moved_away(const std::string& why) {
  Outcome outcome = Outcome::failure(why);
  outcome.end = MotionEnd::target_moved;
  return outcome;
}

Outcome out_of_reach() {
  return Outcome::failure("no configuration of the arm reaches it where it is held now");
}

/// Returns the motion to the stand-off of a grasp, which follows the object.
MotionSpec approach_to(const Parts& parts, const TakeAttempt& take, const Grasp& grasp) {
  const std::string& object = take.offer.object;
  MotionSpec approach;
  approach.phase = ActionPhase::approach;
  approach.goals = {grasp.approach_joints};
  approach.tolerated = {take.offer.giver};
  approach.object = ObjectTarget{object, parts.now.object(object)->T_world_object.translation(),
                                 parts.settings.approach_slack, grasp};
  approach.timeout = parts.settings.take_approach_timeout;
  if (take.attempt > parts.settings.direct_attempts) return approach;
  const double straight = (grasp.approach_joints - parts.arm.joints()).cwiseAbs().maxCoeff();
  approach.max_length =
      parts.settings.max_detour * straight + take.attempt * parts.settings.detour_per_attempt;
  return approach;
}

/// Retreats the hand at once, only far enough to leave space for what the giver holds.
Routine<Outcome> step_back(Parts& parts, const Offer& offer) {
  const bool ready = co_await parts.link.await_permission();
  if (!ready) co_return parts.link.not_permitted();
  const Vector start = parts.arm.configuration();
  MotionSpec back;
  back.phase = ActionPhase::stepping_back;
  back.shape = MotionShape::straight_axes;
  back.allowed = {offer.object, offer.giver};
  const std::vector<Vector3> directions = retreat_directions_from(parts, offer.giver);
  for (const Vector3& direction : directions) {
    Pose T = parts.arm.T_world_tool();
    T.translation() += parts.settings.step_back * direction;
    const auto joints = parts.arm.reach(T);
    if (!joints) continue;
    const Vector q = RobotModel::with(start, parts.arm.group(), *joints);
    if (!parts.retreat.leads_away(start, q, parts.now.T_world_base(), parts.now.people())) continue;
    back.goals = {*joints};
    PlannedPath planned = co_await plan_path(parts, start, back);
    if (!planned.outcome.good) continue;
    parts.action.phase = back.phase;
    Outcome stepped = co_await execute(parts, planned.waypoints, back);
    co_return stepped;
  }
  Outcome none = Outcome::failure("no straight path leads off " + offer.giver);
  parts.refuse("stepping back", none.reason);
  co_return none;
}

/// Returns the straight motion back to the stand-off of a grasp.
MotionSpec back_along(const Offer& offer, const Grasp& grasp, ActionPhase phase, double speed) {
  MotionSpec back;
  back.phase = phase;
  back.shape = MotionShape::straight_axes;
  back.goals = {grasp.approach_joints};
  back.allowed = {offer.object, offer.giver};
  back.speed = speed;
  return back;
}

/// Opens the hand and moves it back to the stand-off; returns `why`.
Routine<Outcome> back_off(Parts& parts, const Offer& offer, const Grasp& grasp,
                          const Outcome& why) {
  parts.action.phase = ActionPhase::backing_off;
  const double timeout = parts.settings.hand_timeout;
  HandResult opened = co_await parts.hand.run(HandAction::move, grasp.pregrasp_joints, timeout);
  if (!opened.outcome.good) parts.refuse("backing off", opened.outcome.reason);
  const MotionSpec back =
      back_along(offer, grasp, ActionPhase::backing_off, parts.settings.approach_speed);
  Outcome backed = co_await move(parts, back);
  if (!backed.good) parts.refuse("backing off", backed.reason);
  parts.offers.set_hand_at_offer(false);
  co_return why;
}

/// Retreats straight while the giver's hand is still exempt from separation: nothing but straight
/// away leads off from so near.
Routine<Outcome> retreat_from_offer(Parts& parts, const Offer& offer) {
  const SceneObject* held = parts.now.object(offer.object);
  const Vector3 p_hand = parts.arm.T_world_tool().translation();
  const Person* giver = parts.now.person(offer.giver);
  const auto is_far = [&](const Vector3& p) {
    return (p - p_hand).norm() > parts.settings.beside_range;
  };
  const auto is_joint_far = [&is_far](const BodyJoint& joint) { return is_far(joint.position); };
  const bool is_clear =
      giver == nullptr || std::all_of(giver->joints.begin(), giver->joints.end(), is_joint_far);
  if (held == nullptr || (is_clear && is_far(held->T_world_object.translation())))
    co_return Outcome{};
  MotionSpec next;
  next.goals = {RobotModel::part(parts.arm.robot().rest_configuration(), parts.arm.group())};
  next.allowed = {offer.object};
  Outcome drawn = co_await retreat_from(parts, offer.giver, next);
  if (!drawn.good) parts.refuse("retreating", drawn.reason);
  co_return drawn;
}

/// Moves to the stand-off and aims `grasp` at where the object is then.
Routine<Step> approach_offer(Parts& parts, const TakeAttempt& take, std::optional<Grasp>& grasp) {
  const auto& [object, giver] = take.offer;
  const MotionSpec approach = approach_to(parts, take, *grasp);
  Outcome moved = co_await move(parts, approach);
  if (is_put_into_hand(parts, take)) co_return Step{Progress::in_hand, moved};
  if (!moved.good && !moved.target_moved()) co_return Step{Progress::failed, moved};
  if (moved.end == MotionEnd::giver_approached) co_await step_back(parts, take.offer);
  const auto is_decided = [&] {
    return is_offered(parts, take.offer) || is_put_into_hand(parts, take) ||
           parts.offers.is_withdrawn();
  };
  co_await parts.waiting.until(is_decided, parts.settings.sight_timeout);
  if (is_put_into_hand(parts, take)) co_return Step{Progress::in_hand, moved};
  if (!is_offered(parts, take.offer))
    co_return Step{Progress::failed, moved_away(giver + " has drawn " + object + " back")};
  grasp = grasp_now(parts, object, take.chosen);
  if (!grasp) co_return Step{Progress::failed, out_of_reach()};
  const Vector q = parts.arm.set_point_with(grasp->approach_joints);
  const RobotModel& robot = parts.arm.robot();
  const Pose T_standoff = parts.now.T_world_base() * robot.link_pose(q, parts.arm.palm());
  const double error = (T_standoff.translation() - parts.arm.T_world_tool().translation()).norm();
  co_return Step{
      error > parts.settings.max_standoff_error ? Progress::again : Progress::at_standoff,
      moved_away(object + " is moved about")};
}

/// Moves straight in from the stand-off.
Routine<Step> reach_offer(Parts& parts, const TakeAttempt& take, std::optional<Grasp>& grasp) {
  const auto& [object, giver] = take.offer;
  Outcome done = co_await parts.hand.await_open();
  if (!done.good) co_return Step{Progress::failed, done};
  std::vector<Grasp> this_one{*grasp};
  done = co_await select_clear_of_hand(parts, take.offer, this_one);
  const SceneObject* seen = parts.now.object(object);
  if (done.good && seen == nullptr) done = Outcome::out_of_sight(object);
  if (!done.good) co_return Step{Progress::failed, done};
  const Vector3 p_object = seen->T_world_object.translation();
  parts.action.exchange_point = p_object;
  MotionSpec reach;
  reach.phase = ActionPhase::reaching_object;
  reach.goals = {grasp->arm_joints};
  reach.shape = MotionShape::straight_axes;
  reach.allowed = {object, giver};
  reach.object = ObjectTarget{object, p_object, parts.settings.aim_slack, std::nullopt};
  reach.timeout = parts.settings.take_reach_timeout;
  parts.offers.set_hand_at_offer(true);
  done = co_await move(parts, reach);
  if (done.good) co_return Step{Progress::in_hand, done};
  done = co_await back_off(parts, take.offer, *grasp, done);
  if (!done.target_moved() || !is_offered(parts, take.offer))
    co_return Step{Progress::failed, done};
  if (is_at(parts, object, p_object))
    co_return Step{Progress::failed, Outcome::failure("the hand pushes " + object + " away")};
  grasp = grasp_now(parts, object, take.chosen);
  co_return Step{grasp ? Progress::again : Progress::failed, done};
}

/// What closing the hand came to.
struct Closing {
  Outcome outcome;
  bool unsure{};  ///< the fingers have closed, but do not all push as planned
};

/// Closes the hand; what lies in it otherwise than planned is pressed on where the fingers are.
Routine<Closing> close_on_offer(Parts& parts, const TakeAttempt& take, const Grasp& grasp) {
  parts.action.phase = ActionPhase::grasp;
  parts.offers.set_hand_at_offer(true);
  const bool is_laid_in = is_put_into_hand(parts, take);
  const Vector closing =
      is_laid_in ? RobotModel::part(parts.now.set_point(), parts.arm.fingers()) : grasp.hand_joints;
  const double timeout = parts.settings.hand_timeout;
  HandResult closed =
      co_await parts.hand.run(HandAction::grasp, closing, timeout, &grasp.hand_effort);
  Closing result{closed.outcome, false};
  if (!closed.outcome.good || closed.state == HandState::grasped || is_laid_in) co_return result;
  result.outcome = Outcome::failure("the hand did not get hold of it");
  result.unsure = true;
  co_return result;
}

/// Returns whether a surface bears the object between the fingers, as the giver has left it there.
bool is_left_in_hand(const Parts& parts, const std::string& object, const Grasp& grasp) {
  const SceneObject* seen = parts.now.object(object);
  if (seen == nullptr || seen->holder != Holder::surface) return false;
  const Pose T_world_object = parts.arm.T_world_tool() * grasp.T_object_hand.inverse();
  return (seen->T_world_object.translation() - T_world_object.translation()).norm() <
         parts.settings.max_in_hand_error;
}

/// Waits until the giver has released the object. Fingers that press on the object feel some of its
/// weight, too: the object is the robot's when that stays and the giver's hand has gone. A hand
/// that is sure of its grip has the object as well when nobody else holds it: it must not open. So
/// has every hand what is left standing between its fingers.
Routine<Outcome> await_release(Parts& parts, const TakeAttempt& take, const Grasp& grasp,
                               bool is_sure) {
  const Offer& offer = take.offer;
  parts.action.phase = ActionPhase::waiting_for_release;
  const auto is_given = [&] {
    const SceneObject* seen = parts.now.object(offer.object);
    const bool has_it = is_held_by_robot(parts, offer.object) ||
                        (is_sure && seen != nullptr && seen->holder == Holder::nobody) ||
                        is_left_in_hand(parts, offer.object, grasp);
    return has_it && !parts.held.is_at_hand_of(offer.giver, offer.object);
  };
  const double timeout = is_sure ? parts.settings.let_go_timeout : parts.settings.unsure_grip_time;
  const TimePoint deadline = parts.now.time() + from_seconds(timeout);
  TimePoint since = parts.now.time();
  while (parts.now.time() < deadline &&
         to_seconds(parts.now.time() - since) < parts.settings.release_time) {
    if (!is_given()) since = parts.now.time();
    co_await parts.waiting.pause(parts.settings.release_check_period);
  }
  co_return is_given() ? Outcome{}
                       : Outcome::failure(offer.giver + " does not release " + offer.object);
}

/// Lifts what the giver has left standing in the hand; what stays behind is released.
Routine<Outcome> lift_what_is_left(Parts& parts, const Offer& offer, const Grasp& grasp) {
  Outcome lifted = co_await lift(parts, offer.object, "", offer.giver);
  const auto is_carried = [&] { return is_held_by_robot(parts, offer.object); };
  if (lifted.good) {
    const bool is_up = co_await parts.waiting.until(is_carried, parts.settings.settle_time);
    if (is_up) co_return lifted;
    lifted = Outcome::failure(offer.object + " stayed behind when the hand went up",
                              ActionFailure::left_behind);
  }
  parts.held.release();
  Outcome off = co_await back_off(parts, offer, grasp, lifted);
  co_return off;
}

/// Draws what was taken back along the approach; `is_lifted`: from above where it was taken.
Routine<Outcome> draw_back(Parts& parts, const Offer& offer, const Grasp& grasp, bool is_lifted) {
  if (is_lifted) {
    Outcome drawn = co_await retreat(parts, offer.giver, offer.object);
    co_return drawn;
  }
  const MotionSpec back =
      back_along(offer, grasp, ActionPhase::retreat, parts.settings.carry_speed);
  Outcome drawn = co_await move(parts, back);
  co_return drawn;
}

/// Plans the approach and begins to open the hand.
Routine<Outcome> begin_approach(Parts& parts, const TakeAttempt& take, const Grasp& grasp) {
  const MotionSpec approach = approach_to(parts, take, grasp);
  const Vector opened =
      RobotModel::with(parts.now.set_point(), parts.arm.fingers(), take.chosen.pregrasp_joints);
  PlannedPath path = co_await plan_path(parts, opened, approach);
  if (!path.outcome.good) co_return path.outcome.of("approach");
  Outcome opening = co_await parts.hand.send(HandAction::move, take.chosen.pregrasp_joints);
  co_return opening;
}

}  // namespace

Routine<Outcome> take(Parts& parts, const TakeAttempt& take) {
  const auto& [object, giver] = take.offer;
  parts.action.phase = ActionPhase::planning;
  const bool ready = co_await parts.link.await_permission();
  if (!ready) co_return parts.link.not_permitted();
  std::optional<Grasp> grasp = grasp_now(parts, object, take.chosen);
  if (!grasp) co_return out_of_reach();
  Outcome begun = co_await begin_approach(parts, take, *grasp);
  if (!begun.good && is_near_object(parts, object)) {
    // The opening fingers may touch what is offered so near: from farther back they do not.
    co_await retreat_from_offer(parts, take.offer);
    grasp = grasp_now(parts, object, take.chosen);
    if (!grasp) co_return out_of_reach();
    begun = co_await begin_approach(parts, take, *grasp);
  }
  if (!begun.good) co_return begun;
  Step step;
  for (std::uint32_t aims = 0; aims < parts.settings.take_aims; ++aims) {
    step = co_await approach_offer(parts, take, grasp);
    if (step.progress == Progress::again) continue;
    if (step.progress == Progress::at_standoff) step = co_await reach_offer(parts, take, grasp);
    if (step.progress != Progress::again) break;
  }
  if (step.progress != Progress::in_hand) {
    co_await retreat_from_offer(parts, take.offer);
    co_return step.outcome;
  }
  const Closing closed = co_await close_on_offer(parts, take, *grasp);
  Outcome taken = closed.outcome;
  if (taken.good) taken = co_await await_release(parts, take, *grasp, true);
  if (closed.unsure) {
    // A giver who feels the robot hold the object releases it at once: a hand that opened then
    // would drop it. One who still holds it keeps their hand there.
    const Outcome released = co_await await_release(parts, take, *grasp, false);
    if (released.good) taken = released;
  }
  if (!taken.good) {
    Outcome off = co_await back_off(parts, take.offer, *grasp, taken);
    co_return off;
  }
  parts.held.set_grasp(*grasp);
  parts.held.hold(*parts.now.object(object));
  const bool is_standing = is_left_in_hand(parts, object, *grasp);
  if (is_standing) {
    taken = co_await lift_what_is_left(parts, take.offer, *grasp);
    if (!taken.good) co_return taken;
  }
  Outcome moved = co_await draw_back(parts, take.offer, *grasp, is_standing);
  parts.offers.set_hand_at_offer(false);
  if (!moved.good) parts.refuse("retreat", moved.reason);
  co_return Outcome{};
}

}  // namespace handsel::manipulation_planner
