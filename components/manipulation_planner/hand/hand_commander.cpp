// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/hand/hand_commander.hpp"

namespace handsel::manipulation_planner {

Routine<Outcome> HandCommander::send(HandAction action, const Vector& position,
                                     const Vector* effort, double mass_ratio) {
  HandCommand command = link_.hand_command();
  command.action = action;
  command.position = position;
  if (effort != nullptr) command.effort = *effort;
  command.pull_force = settings_.pull_force;
  command.both_hands = mass_ratio < 1.0;
  if (const ObjectModel* grasped = now_.model_of(action_.object);
      action == HandAction::grasp && grasped != nullptr)
    command.payload = mass_ratio * grasped->mass;
  const std::uint64_t id = command.id;
  const auto is_acknowledged = [this, id] {
    return now_.execution()->hand_command == id && arm_.hand_state() != HandState::refused;
  };
  bool acknowledged = false;
  for (std::uint32_t tries = 0; tries < settings_.hand_command_tries && !acknowledged; ++tries) {
    const bool ready =
        co_await waiting_.until([this] { return link_.may_move(); }, settings_.permission_timeout);
    if (!ready) break;
    command.epoch = now_.execution()->epoch;
    link_.send(command);
    acknowledged = co_await waiting_.until(is_acknowledged, settings_.hand_command_period);
  }
  arm_.set_finger_goal(std::nullopt);
  if (acknowledged && action == HandAction::move) arm_.set_finger_goal(position);
  if (!acknowledged) co_return Outcome::failure("hand command not accepted: " + link_.reason());
  co_return Outcome{};
}

Routine<Outcome> HandCommander::await_open() {
  const bool open = co_await waiting_.until(
      [this] { return arm_.hand_state() != HandState::moving; }, settings_.hand_timeout);
  co_return open ? Outcome{} : Outcome::failure("the hand does not open");
}

Routine<HandResult> HandCommander::run(HandAction action, const Vector& position, double timeout,
                                       const Vector* effort, double mass_ratio) {
  HandResult result;
  for (std::uint32_t tries = 0; tries < settings_.hand_interruptions; ++tries) {
    result.outcome = co_await send(action, position, effort, mass_ratio);
    if (!result.outcome.good) co_return result;
    const std::uint64_t id = now_.execution()->hand_command;
    const auto is_lost = [this, id] { return now_.execution()->hand_command != id; };
    const bool ended = co_await waiting_.until(
        [&] { return is_lost() || arm_.hand_state() != HandState::moving; }, timeout);
    if (is_lost()) result.outcome = Outcome::failure("the controller lost the hand command");
    if (!ended) result.outcome = Outcome::failure("the hand does not come to an end");
    result.state = arm_.hand_state();
    if (!result.outcome.good || result.state != HandState::refused) co_return result;
  }
  result.outcome = Outcome::failure("stops interrupted the hand " +
                                    std::to_string(settings_.hand_interruptions) + " times");
  co_return result;
}

Routine<HandResult> HandCommander::release_on_pull(const Vector& position, double timeout,
                                                   const std::function<bool()>& is_over,
                                                   double mass_ratio) {
  HandResult result =
      co_await run(HandAction::release_on_pull, position, timeout, nullptr, mass_ratio);
  if (!result.outcome.good) co_return result;
  const std::uint64_t id = now_.execution()->hand_command;
  const auto is_lost = [this, id] { return now_.execution()->hand_command != id; };
  const auto has_ended = [&] {
    const HandState state = arm_.hand_state();
    return is_lost() || state == HandState::released || state == HandState::refused || is_over();
  };
  co_await waiting_.until(has_ended, timeout);
  if (is_lost()) result.outcome = Outcome::failure("the controller lost the hand command");
  result.state = arm_.hand_state();
  co_return result;
}

}  // namespace handsel::manipulation_planner
