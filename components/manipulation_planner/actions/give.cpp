// SPDX-License-Identifier: Apache-2.0
// The action give.
#include "common/model/human/human_body.hpp"
#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/handover/otp_choice.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"

namespace handsel::manipulation_planner {
namespace {

/// Returns the motion that carries the object to the receiver.
MotionSpec carry_motion(const Parts& parts, const std::string& object, const OtpSearch& search,
                        const Person& receiver) {
  MotionSpec carry;
  carry.phase = ActionPhase::carry;
  carry.speed = parts.settings.carry_speed;
  carry.allowed = {object};
  carry.yields_to = receiver.id;
  aim_at(search, receiver, parts.receiver_hands, carry);
  return carry;
}

/// Carries the object to the receiver, again if they move; waits for a receiver out of reach.
Routine<Outcome> carry_to(Parts& parts, const std::string& object, const std::string& receiver) {
  Outcome last;
  const auto& settings = parts.settings;
  const TimePoint deadline = parts.now.time() + from_seconds(settings.reach_timeout);
  for (std::uint32_t attempt = 0; attempt < settings.motion_attempts;) {
    parts.action.phase = ActionPhase::choosing_exchange_point;
    const Person* person = parts.now.person(receiver);
    if (person == nullptr) co_return Outcome::out_of_sight("person " + receiver);
    OtpChoice choice = co_await choose_otp(parts, receiver, nullptr);
    last = choice.outcome;
    if (last.good && choice.search.poses.empty()) {
      last = Outcome::failure(choice.search.reason);
      if (parts.now.time() >= deadline) {
        parts.refuse("exchange point", last.reason);
        co_return last;
      }
      parts.action.phase = ActionPhase::waiting_for_person;
      co_await parts.waiting.pause(settings.reach_pause);
      continue;
    }
    ++attempt;
    if (!last.good) continue;
    person = parts.now.person(receiver);
    if (person == nullptr) co_return Outcome::out_of_sight("person " + receiver);
    MotionSpec carry = carry_motion(parts, object, choice.search, *person);
    show(choice.search.poses.front(), parts.action);
    parts.shift.note_choice(parts.action.exchange_point, parts.now.time());
    last = co_await move(parts, carry);
    if (last.end == MotionEnd::taken) co_return Outcome{};
    if (!last.good) continue;
    if (settings.live_period <= 0 || attempt >= settings.motion_attempts) co_return last;
    const Vector here = RobotModel::part(parts.arm.configuration(), parts.arm.group());
    if (parts.shift.has_led_to(parts.held.T_world_object().translation())) carry.goals = {here};
    const bool has_moved = co_await follow_receiver(parts, carry, here);
    if (!has_moved) co_return last;
  }
  co_return last;
}

/// Moves what is offered as attention asks for; where that fails it is offered where it is.
Routine<Outcome> shift_offer(Parts& parts, const std::string& object, const std::string& receiver) {
  const Person* person = parts.now.person(receiver);
  if (person == nullptr) co_return Outcome::out_of_sight("person " + receiver);
  MotionSpec carry = carry_motion(parts, object, {}, *person);
  const Vector here = RobotModel::part(parts.arm.configuration(), parts.arm.group());
  carry.goals = {here};
  const bool is_shifted = co_await follow_shift(parts, carry, here);
  if (!is_shifted) co_return Outcome{};
  Outcome moved = co_await move(parts, carry);
  co_return moved;
}

/// Returns whether a person holds the object; false where it is not seen.
bool is_held_by_person(const Parts& parts, const std::string& object) {
  const SceneObject* seen = parts.now.object(object);
  return seen != nullptr && seen->holder == Holder::human;
}

/// Returns whether a person has drawn the object out of the hand, as from a hand that could not
/// feel the pull.
bool is_drawn_out(const Parts& parts, const std::string& object) {
  return is_held_by_person(parts, object) && !parts.held.is_in_hand(*parts.now.object(object));
}

/// Closes the hand on the object that it offers; `is_open`: the fingers have begun to open.
Routine<HandResult> keep(Parts& parts, bool is_open) {
  Vector grip = RobotModel::part(parts.now.set_point(), parts.arm.fingers()), effort;
  if (const std::optional<Grasp>& grasp = parts.held.grasp(); is_open && grasp) {
    grip = grasp->hand_joints;
    effort = grasp->hand_effort;
  }
  HandResult held = co_await parts.hand.run(HandAction::grasp, grip, parts.settings.hand_timeout,
                                            effort.size() > 0 ? &effort : nullptr);
  if (!held.outcome.good) parts.refuse("keeping the object", held.outcome.reason);
  co_return held;
}

/// Opens the hand off what a person holds, again where stops interrupt that.
Routine<HandResult> let_go(Parts& parts, const Vector& open, TimePoint deadline) {
  HandResult released;
  do {
    released = co_await parts.hand.run(HandAction::release, open, parts.settings.hand_timeout);
  } while (!released.outcome.good && parts.now.time() < deadline);
  co_return released;
}

/// What an offer came to.
struct Offered {
  Outcome outcome;      ///< whether the receiver has the object, or it is to be offered elsewhere
  bool is_elsewhere{};  ///< attention wants the offer elsewhere; the hand has closed again
};

/// Offers the object until the receiver takes it or the offer is wanted elsewhere; else the hand
/// keeps it.
Routine<Offered> offer(Parts& parts, const std::string& object, const std::string& receiver,
                       TimePoint deadline) {
  parts.action.phase = ActionPhase::offer;
  show_offered(parts, receiver);
  parts.action.exchange_engaged = true;
  const Vector open = opening(parts);
  const auto is_wanted_elsewhere = [&] {
    return parts.settings.follow_receiver && !parts.held.is_taken_by(receiver) &&
           parts.shift.wanted(parts.action.exchange_point, parts.now.time()).has_value();
  };
  const std::function<bool()> is_over = [&] {
    return is_drawn_out(parts, object) || is_wanted_elsewhere();
  };
  HandResult released;
  for (;;) {
    const double left = to_seconds(deadline - parts.now.time());
    released = co_await parts.hand.release_on_pull(open, left, is_over);
    if (!released.outcome.good) break;
    if (released.state == HandState::released) co_return Offered{};
    const bool interrupted = released.state == HandState::refused;
    if (!interrupted && !is_drawn_out(parts, object) && is_wanted_elsewhere()) {
      parts.action.exchange_engaged = false;
      const HandResult held = co_await keep(parts, false);
      co_return Offered{held.outcome, true};
    }
    bool has_person_it =
        is_drawn_out(parts, object) || (interrupted && !is_held_by_robot(parts, object));
    if (interrupted && !has_person_it) {
      const HandResult held = co_await keep(parts, true);
      // Closed on nothing: the person has drawn the object out, or a finger is caught on it. Not
      // closed, for stops: the person may have it meanwhile.
      has_person_it =
          held.outcome.good ? held.state != HandState::grasped : is_held_by_person(parts, object);
    }
    if (has_person_it) {
      released = co_await let_go(parts, open, deadline);
      co_return Offered{released.outcome};
    }
    if (!interrupted || parts.now.time() >= deadline) break;
  }
  parts.action.exchange_engaged = false;
  co_await keep(parts, false);
  if (!released.outcome.good) co_return Offered{released.outcome};
  parts.held.note_vain_offer();
  co_return Offered{
      Outcome::failure(receiver + " did not take " + object + " within " +
                           std::to_string(static_cast<int>(parts.settings.offer_timeout)) + " s",
                       ActionFailure::not_taken)};
}

/// Offers the object until the receiver takes it, elsewhere as often as attention asks for.
Routine<Outcome> offer_and_shift(Parts& parts, const std::string& object,
                                 const std::string& receiver) {
  const TimePoint deadline = parts.now.time() + from_seconds(parts.settings.offer_timeout);
  Offered offered;
  do {
    offered = co_await offer(parts, object, receiver, deadline);
    if (!offered.outcome.good || !offered.is_elsewhere) break;
    const Outcome shifted = co_await shift_offer(parts, object, receiver);
    if (!shifted.good) parts.refuse("shift of the exchange point", shifted.reason);
  } while (true);
  co_return offered.outcome;
}

/// Returns whether a pull toward the person draws the object out of the opened fingers, not against
/// one of them, as where a finger is inside a cup.
bool is_drawn_past_fingers(const Parts& parts, const std::string& object,
                           const std::string& receiver) {
  const Person* person = parts.now.person(receiver);
  if (person == nullptr) return true;
  const Vector3& p_trunk =
      person->joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  const Vector3 pull =
      (p_trunk - parts.arm.T_world_tool().translation()).cwiseProduct(Vector3(1, 1, 0));
  return pull.stableNormalized().dot(-retreat_direction(parts, object)) >=
         parts.settings.drawn_out_cosine;
}

}  // namespace

Routine<Outcome> give(Parts& parts, const std::string& object, const std::string& human) {
  const SceneObject* held = parts.now.object(object);
  if (held == nullptr) co_return Outcome::failure("object " + object + " is not in the scene");
  if (held->holder == Holder::human && !parts.held.is_in_hand(*held)) co_return Outcome{};
  if (!parts.held.is_holding() || parts.held.id() != object)
    co_return Outcome::failure("the hand does not hold " + object);
  parts.action.phase = ActionPhase::choosing_exchange_point;
  const auto is_seen = [&] { return parts.now.person(human) != nullptr; };
  const bool seen = co_await parts.waiting.until(is_seen, parts.settings.sight_timeout);
  if (!seen)
    co_return human.empty()
        ? Outcome::failure("nobody is in sight")
        : Outcome::failure("person " + human + " is not in sight", ActionFailure::not_visible);
  const std::string receiver = parts.now.person(human)->id;
  parts.action.human = receiver;
  parts.receiver_hands = {};
  // In the hand, yet not borne by it: somebody has hold of the object already.
  const SceneObject* now = parts.now.object(object);
  const bool is_taken =
      parts.held.is_taken_by(receiver) || (now != nullptr && now->holder != Holder::robot);
  if (!is_taken) {
    Outcome carried = co_await carry_to(parts, object, receiver);
    if (!carried.good) co_return carried;
  } else {
    parts.shift.note_choice(parts.held.T_world_object().translation(), parts.now.time());
  }
  Outcome offered = co_await offer_and_shift(parts, object, receiver);
  if (!offered.good) co_return offered;
  parts.held.release();
  parts.action.phase = ActionPhase::retreat;
  if (is_drawn_past_fingers(parts, object, receiver))
    co_await parts.waiting.pause(parts.settings.take_pause);
  Outcome back = co_await retreat(parts, receiver, object);
  if (!back.good) parts.refuse("retreat", back.reason);
  co_return Outcome{};
}

}  // namespace handsel::manipulation_planner
