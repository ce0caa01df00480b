// SPDX-License-Identifier: Apache-2.0
// The action give with both hands, a closed chain: takes the object where it stands, lifts it,
// brings it to the receiver, releases it with both hands at a pull on them, and retreats. What is
// not taken is put back.
#include <functional>
#include <memory>
#include <optional>

#include "common/messages/names.hpp"
#include "common/model/arm_reach.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/object_extent.hpp"
#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/actions/together.hpp"
#include "components/manipulation_planner/handover/two_hand_otp.hpp"
#include "components/manipulation_planner/placing/place_search.hpp"

namespace handsel::manipulation_planner {
namespace {

/// A give with both hands that is under way.
struct GiveTogether {
  std::string object, receiver;            ///< ids
  TogetherPlan plan;                       ///< how the hands take the object
  Pose T_world_start{Pose::Identity()};    ///< where the object stood
  Vector3 p_world_torso{Vector3::Zero()};  ///< of the receiver at the last choice of a point [m]
};

const Vector3& p_torso_of(const Person& person) {
  return person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
}

/// Returns whether the receiver has moved since the last choice; false where they are not seen.
bool has_receiver_moved(const Parts& parts, const GiveTogether& give) {
  const Person* person = parts.now.person(give.receiver);
  return person != nullptr &&
         (p_torso_of(*person) - give.p_world_torso).norm() >= parts.settings.follow_step;
}

/// Returns the shoulders and reaches of all arms.
std::vector<ArmPlace> arm_places(const Parts& parts) {
  std::vector<ArmPlace> out;
  const RobotModel& robot = parts.arm.robot();
  for (const Manipulator& m : parts.arm.manipulators()) {
    const ArmReach reach = arm_reach(robot, m.arm, m.palm);
    if (m.arm == nullptr || reach.shoulder < 0) continue;
    const Pose T_root_shoulder = robot.link_pose(parts.now.set_point(), reach.shoulder);
    out.push_back({(parts.now.T_world_base() * T_root_shoulder).translation(),
                   reach.length - kObjectBeyondTool});
  }
  return out;
}

/// Searches exchange points for the receiver as they are now.
Routine<TwoHandOtp> choose_together(Parts& parts, GiveTogether& give) {
  auto found = std::make_shared<TwoHandOtp>();
  const Person* person = parts.now.person(give.receiver);
  const SceneObject* object = parts.now.object(give.object);
  if (person == nullptr || object == nullptr) {
    found->reason = (person == nullptr ? "person " + give.receiver : "object " + give.object) +
                    " is out of sight";
    co_return *found;
  }
  give.p_world_torso = p_torso_of(*person);
  const Vector3 p_robot = T_world_platform(parts.now).translation();
  const std::function<void()> job =
      [found, scene = parts.now.scene(), layers = parts.now.layers(), who = *person,
       T_world_object = object->T_world_object,
       extent = object_extent(parts.now.model_of(give.object), object->primitive),
       arms = arm_places(parts), p_robot, settings = parts.settings] {
        const TwoHandOtpQuery query{scene, who, layers, T_world_object, extent, arms, p_robot};
        *found = find_two_hand_otp(query, settings);
      };
  const Outcome worked = co_await parts.worker.run(job);
  if (!worked.good) found->reason = worked.reason;
  co_return *found;
}

/// Plans how the hands take the object and where they offer it; waits for a receiver out of reach.
Routine<Outcome> plan_give(Parts& parts, GiveTogether& give) {
  const TimePoint deadline = parts.now.time() + from_seconds(parts.settings.reach_timeout);
  Outcome last;
  do {
    parts.action.phase = ActionPhase::choosing_exchange_point;
    const TwoHandOtp otp = co_await choose_together(parts, give);
    last = Outcome::failure(otp.reason);
    if (!otp.T_world_object.empty()) {
      give.plan =
          co_await ask_together(parts, give.object, otp.T_world_object, HandsUse::together_in_air);
      last = give.plan.outcome;
    }
    if (last.good) co_return last;
    parts.refuse("both hands together", last.reason);
    parts.action.phase = ActionPhase::waiting_for_person;
    co_await parts.waiting.pause(parts.settings.reach_pause);
  } while (parts.now.time() < deadline);
  co_return last;
}

/// Returns whether a person has drawn the object out of the hands.
bool is_out_of_both(const Parts& parts, const std::string& object) {
  const SceneObject* seen = parts.now.object(object);
  return seen != nullptr && seen->holder == Holder::human && !parts.held.is_in_hand(*seen);
}

/// Lifts the object and checks that it comes along.
Routine<Outcome> lift_together(Parts& parts, const GiveTogether& give) {
  parts.action.phase = ActionPhase::lift;
  TogetherMotion motion = together_motion(parts, give.object, give.plan);
  motion.T_world_object = {raised(give.T_world_start, parts.settings.lift_height)};
  Outcome done = co_await move_together(parts, motion);
  if (!done.good) co_return done;
  const double min_height = give.T_world_start.translation().z() +
                            parts.settings.two_hand_min_lift_ratio * parts.settings.lift_height;
  const auto is_lifted = [&] {
    const SceneObject* held = parts.now.object(give.object);
    return held != nullptr && held->T_world_object.translation().z() >= min_height;
  };
  const bool lifted = co_await parts.waiting.until(is_lifted, parts.settings.settle_time);
  if (!lifted)
    co_return Outcome::failure(give.object + " stayed behind when both hands went up",
                               ActionFailure::left_behind);
  co_return Outcome{};
}

/// Carries the object to the first of the poses that both arms reach. Ends early where the receiver
/// takes hold, or moves: then another point is to be chosen.
Routine<Outcome> carry_to_any(Parts& parts, const GiveTogether& give,
                              const std::vector<Pose>& T_world_object) {
  Outcome last = Outcome::failure("no exchange point was found");
  TogetherMotion motion = together_motion(parts, give.object, give.plan);
  motion.spec.yields_to = give.receiver;
  motion.is_watched = true;
  motion.is_over = [&parts, &give] { return has_receiver_moved(parts, give); };
  for (const Pose& T : T_world_object) {
    parts.action.exchange_point = T.translation();
    motion.T_world_object = {T};
    last = co_await move_together(parts, motion);
    if (last.good || last.is_final()) co_return last;
    parts.refuse("carry with both hands", last.reason);
  }
  co_return last;
}

/// Brings the object to the receiver, again if they move.
Routine<Outcome> bring_together(Parts& parts, GiveTogether& give) {
  std::vector<Pose> goals{give.plan.down.T_world_object};
  Outcome last;
  for (std::uint32_t attempt = 0; attempt < parts.settings.motion_attempts; ++attempt) {
    if (attempt > 0 || has_receiver_moved(parts, give)) {
      parts.action.phase = ActionPhase::choosing_exchange_point;
      const TwoHandOtp otp = co_await choose_together(parts, give);
      if (!otp.T_world_object.empty()) goals = otp.T_world_object;
      if (!otp.reason.empty()) parts.refuse("exchange point", otp.reason);
    }
    parts.action.phase = ActionPhase::carry;
    last = co_await carry_to_any(parts, give, goals);
    if (last.end == MotionEnd::taken) co_return Outcome{};
    if (last.good && !has_receiver_moved(parts, give)) co_return last;
    if (!last.good && !last.is_final()) co_await parts.waiting.pause(parts.settings.attempt_pause);
  }
  co_return last;
}

/// Sends a command to each hand, the following one first, and waits for its end.
Routine<Outcome> command_both(Parts& parts, const GiveTogether& give, HandAction action) {
  const std::vector<const RegraspStep*> steps{&give.plan.second, &give.plan.first};
  Outcome last;
  for (const RegraspStep* step : steps) {
    Outcome used = co_await use_arm(parts, step->to);
    if (!used.good) co_return used;
    const bool closes = action == HandAction::grasp;
    const Vector& position = closes ? step->grasp.hand_joints : step->grasp.pregrasp_joints;
    const Vector* effort = closes ? &step->grasp.hand_effort : nullptr;
    HandResult result = co_await parts.hand.run(action, position, parts.settings.hand_timeout,
                                                effort, parts.settings.two_hand_mass_fraction);
    if (!result.outcome.good) last = result.outcome;
  }
  co_return last;
}

/// Waits for a pull on both hands that opens them; then the arm of the leading hand is in use.
Routine<HandResult> await_pull(Parts& parts, const GiveTogether& give, TimePoint deadline) {
  HandResult result;
  result.outcome = co_await command_both(parts, give, HandAction::release_on_pull);
  if (!result.outcome.good) co_return result;
  const std::function<bool()> is_over = [&] { return is_out_of_both(parts, give.object); };
  result = co_await parts.hand.release_on_pull(give.plan.first.grasp.pregrasp_joints,
                                               to_seconds(deadline - parts.now.time()), is_over,
                                               parts.settings.two_hand_mass_fraction);
  co_return result;
}

/// Offers the object until the receiver takes it; else both hands keep it.
Routine<Outcome> offer_together(Parts& parts, const GiveTogether& give) {
  parts.action.phase = ActionPhase::offer;
  parts.action.exchange_point = parts.held.T_world_object().translation();
  parts.action.exchange_engaged = true;
  const TimePoint deadline = parts.now.time() + from_seconds(parts.settings.offer_timeout);
  HandResult released;
  do {
    released = co_await await_pull(parts, give, deadline);
    if (!released.outcome.good) break;
    if (released.state == HandState::released || is_out_of_both(parts, give.object)) {
      // The other hand has felt the same pull; where a stop held it up it opens now.
      Outcome opened = co_await command_both(parts, give, HandAction::release);
      co_return opened;
    }
    Outcome kept = co_await command_both(parts, give, HandAction::grasp);
    if (!kept.good) parts.refuse("keeping the object", kept.reason);
  } while (parts.now.time() < deadline);
  parts.action.exchange_engaged = false;
  if (!released.outcome.good) co_return released.outcome;
  co_return Outcome::failure(give.receiver + " did not take " + give.object + " within " +
                                 std::to_string(static_cast<int>(parts.settings.offer_timeout)) +
                                 " s",
                             ActionFailure::not_taken);
}

/// Moves both opened hands off what the receiver holds.
Routine<Outcome> retreat_both(Parts& parts, const GiveTogether& give) {
  parts.held.release();
  parts.action.phase = ActionPhase::retreat;
  co_await parts.waiting.pause(parts.settings.take_pause);
  const std::vector<const RegraspStep*> steps{&give.plan.first, &give.plan.second};
  for (const RegraspStep* step : steps) {
    Outcome done = co_await use_arm(parts, step->to);
    if (!done.good) co_return done;
    parts.held.set_grasp(step->grasp);
    done = co_await retreat(parts, give.receiver, give.object);
    if (!done.good) parts.refuse("retreat of " + step->to, done.reason);
  }
  co_return Outcome{};
}

/// Puts the object back where it stood and opens the hands; hands that cannot bring it down keep
/// it.
Routine<Outcome> put_back_together(Parts& parts, const GiveTogether& give) {
  Outcome done = co_await use_arm(parts, give.plan.first.to);
  if (!done.good) co_return done;
  parts.held.set_grasp(give.plan.first.grasp);
  parts.action.phase = ActionPhase::put_back;
  TogetherMotion motion = together_motion(parts, give.object, give.plan);
  motion.T_world_object = {raised(give.T_world_start, kAbovePlace)};
  const double height = parts.settings.lift_height;
  const SceneObject* now = parts.now.object(give.object);
  const Pose T_above = raised(give.T_world_start, height);
  const bool is_above =
      now != nullptr &&
      (now->T_world_object.translation() - T_above.translation()).head<2>().norm() <
          parts.settings.regrasp_same_place;
  if (!is_above) motion.T_world_object.insert(motion.T_world_object.begin(), T_above);
  done = co_await move_together(parts, motion);
  if (!done.good) co_return done;
  done = co_await release_both(parts, give.object, give.plan);
  co_return done;
}

}  // namespace

Routine<Outcome> give_together(Parts& parts, const ActionGoal& goal) {
  GiveTogether give;
  give.object = goal.object;
  Outcome done = co_await await_put_down(parts, give.object);
  if (!done.good) co_return done;
  const auto is_seen = [&] { return parts.now.person(goal.human) != nullptr; };
  const bool seen = co_await parts.waiting.until(is_seen, parts.settings.sight_timeout);
  if (!seen)
    co_return Outcome::failure(
        goal.human.empty() ? "nobody is in sight" : "person " + goal.human + " is not in sight",
        ActionFailure::not_visible);
  give.receiver = parts.now.person(goal.human)->id;
  parts.action.human = give.receiver;
  done = co_await rest_all(parts);
  if (!done.good) co_return done;
  done = co_await plan_give(parts, give);
  if (!done.good) co_return done;
  done = co_await try_to_take(parts, give.object, give.plan);
  if (!done.good) co_return done;
  give.T_world_start = parts.now.object(give.object)->T_world_object;
  done = co_await lift_together(parts, give);
  if (done.good) done = co_await bring_together(parts, give);
  if (done.good) done = co_await offer_together(parts, give);
  if (!done.good) {
    parts.refuse(text_of(parts.action.phase), done.reason);
    Outcome back = co_await put_back_together(parts, give);
    if (!back.good) done.reason += "; " + back.reason;
    co_return done;
  }
  done = co_await retreat_both(parts, give);
  if (!done.good) parts.refuse("retreat", done.reason);
  co_return Outcome{};
}

}  // namespace handsel::manipulation_planner
