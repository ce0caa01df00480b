// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/controller_link.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kMaxDuration = 600;  // of a motion whose end is awaited [s]

}  // namespace

bool ControllerLink::may_move() const {
  return !dropped_stop_ && now_.execution() && now_.execution()->mode < Mode::hold;
}

Routine<bool> ControllerLink::await_permission() {
  const bool ready = co_await waiting_.until([this] { return may_move() && arm_.at_rest(); },
                                             settings_.permission_timeout);
  co_return ready;
}

std::string ControllerLink::reason() const {
  return now_.execution() ? now_.execution()->reason : "the controller is silent";
}

Outcome ControllerLink::not_permitted() const {
  return Outcome::failure("no permission to move: " + reason(), ActionFailure::not_permitted);
}

TrajectoryCommand ControllerLink::stop_command() {
  TrajectoryCommand stop;
  stop.id = ids_.next_command();
  stop.epoch = now_.execution()->epoch;
  stop.robot = arm_.robot().name();
  return stop;
}

HandCommand ControllerLink::hand_command() {
  HandCommand command;
  command.id = ids_.next_command();
  command.robot = arm_.robot().name();
  command.group = arm_.hand_name();
  return command;
}

Routine<Outcome> ControllerLink::send(const TrajectoryCommand& command) {
  const std::uint64_t id = command.id;
  for (std::uint32_t tries = 0; tries < settings_.command_tries; ++tries) {
    outbox_.trajectories.push_back(command);
    const bool acknowledged = co_await waiting_.until(
        [this, id] { return now_.execution()->trajectory == id; }, settings_.command_period);
    if (acknowledged) co_return Outcome{};
  }
  co_return Outcome::failure("the trajectory controller does not acknowledge the trajectory");
}

Routine<Outcome> ControllerLink::run(const TrajectoryCommand& command) {
  Outcome sent = co_await send(command);
  if (!sent.good) co_return sent;
  const std::uint64_t id = command.id;
  co_await waiting_.until([this, id] { return has_ended(id); }, kMaxDuration);
  Outcome end = co_await end_of(id);
  co_return end;
}

bool ControllerLink::has_ended(std::uint64_t command) const {
  const ExecutionStatus& status = *now_.execution();
  return status.trajectory != command ||
         (status.motion != MotionState::running && status.motion != MotionState::idle);
}

Routine<Outcome> ControllerLink::end_of(std::uint64_t command) {
  if (now_.execution()->trajectory != command) {
    if (now_.active().trajectory != 0) co_await stop();
    co_return Outcome::failure("the trajectory controller lost the trajectory");
  }
  const MotionState motion = now_.execution()->motion;
  if (motion == MotionState::refused) co_return Outcome::failure("trajectory refused: " + reason());
  if (motion != MotionState::finished)
    co_return Outcome::failure("stopped on the path: " + reason());
  co_await waiting_.until([this] { return arm_.at_rest(); }, settings_.rest_timeout);
  co_return Outcome{};
}

Routine<Outcome> ControllerLink::stop() {
  const TrajectoryCommand command = stop_command();
  for (std::uint32_t tries = 0;
       tries < settings_.command_tries && now_.execution()->trajectory != command.id; ++tries) {
    outbox_.trajectories.push_back(command);
    co_await waiting_.pause(settings_.command_period);
  }
  co_return Outcome{};
}

void ControllerLink::drop_motion() {
  if (now_.active().trajectory == 0) return;
  dropped_stop_.emplace();
  dropped_stop_->id = ids_.next_command();
  dropped_stop_->robot = arm_.robot().name();
  stop_sent_ = {};
}

void ControllerLink::repeat_stop() {
  if (!dropped_stop_) return;
  const auto& status = now_.execution();
  const bool acknowledged =
      status && status->trajectory == dropped_stop_->id && status->motion != MotionState::refused;
  if (acknowledged || now_.active().trajectory == 0) return dropped_stop_.reset();
  if (to_seconds(waiting_.now() - stop_sent_) < settings_.stop_period) return;
  stop_sent_ = waiting_.now();
  dropped_stop_->epoch = status ? status->epoch : 0;
  outbox_.trajectories.push_back(*dropped_stop_);
}

}  // namespace handsel::manipulation_planner
