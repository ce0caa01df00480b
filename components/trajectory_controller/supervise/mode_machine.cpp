// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/mode_machine.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {
namespace {

/// Causes that only slow the motion and name a silent component.
constexpr std::uint32_t kSilent = bit(Cause::attention_silent) | bit(Cause::supervisor_silent);

}  // namespace

ModeVerdict ModeMachine::update(const ModeInputs& in) noexcept {
  std::uint32_t fault = 0, stop = 0, hold = 0, waiting = 0, slow = 0;
  const auto set = [](std::uint32_t& level, Cause cause, bool condition) {
    if (condition) level |= bit(cause);
  };
  set(fault, Cause::tracking_error, in.tracking_error);
  set(fault, Cause::limit_violation, in.limit_violation);

  set(stop, Cause::robot_state_silent, in.robot_age > timeouts_.robot_state);
  set(stop, Cause::human_state_silent, in.human_age > timeouts_.human_state);
  set(stop, Cause::drive_not_enabled, in.robot_age >= 0 && !in.drive_enabled);
  set(stop, Cause::cycle_late, in.set_points_late);
  set(stop, Cause::separation, in.separation_stop);
  set(stop, Cause::contact, in.contact_stop);
  set(stop, Cause::clamped, in.clamped);

  const double forecast_age =
      in.forecast_age < 0 ? in.running_for : std::min(in.forecast_age, in.running_for);
  set(hold, Cause::forecast_silent, in.running && forecast_age > timeouts_.forecast);
  set(hold, Cause::forecast_collision, in.forecast_collision_hold);
  set(hold, Cause::cycle_late, in.cycle_late);
  set(hold, Cause::blind, in.blind);
  set(hold, Cause::unlocalised, in.localisation_age > timeouts_.localisation);
  set(hold, in.awaits_person ? Cause::awaits_person : Cause::no_go,
      in.go_age >= 0 && !in.go_allowed);
  const bool supervisor_silent = in.go_age > timeouts_.supervisor;
  set(supervisor_silent && !in.running ? hold : slow, Cause::supervisor_silent, supervisor_silent);

  // Not received since the start: waits, and needs no newer Go after the first sample.
  set(waiting, Cause::robot_state_silent, in.robot_age < 0);
  set(waiting, Cause::human_state_silent, in.human_age < 0);
  set(waiting, Cause::no_go, in.go_age < 0);

  set(slow, Cause::attention_silent,
      in.attention_age < 0 || in.attention_age > timeouts_.attention);
  set(slow, Cause::forecast_collision, in.forecast_collision_slow);
  set(slow, Cause::separation, in.separation_slow);
  set(slow, Cause::wall, in.wall_slow);
  set(slow, Cause::human_unknown, in.human_unknown);
  set(slow, Cause::attention_slow, in.attention_slow);
  set(slow, Cause::cost_ahead, in.cost_slow);
  set(slow, Cause::override_slow, in.override_slow);
  set(slow, Cause::stop_unproven, in.stop_unproven);
  set(slow, Cause::blind, in.blind_ahead);

  if (fault | stop | hold) {
    latched_ = std::max(latched_, fault ? Mode::fault : stop ? Mode::stop : Mode::hold);
    if (fault || latched_ != Mode::fault) epoch_ = in.go_epoch;
  }
  if (latched_ == Mode::fault && !fault && in.go_acknowledge && in.go_epoch > epoch_)
    latched_ = Mode::stop;
  if (latched_ == Mode::stop && !stop && in.at_rest)
    latched_ = Mode::hold;
  else if (latched_ == Mode::hold && !hold && !waiting && in.go_allowed &&
           in.go_epoch > std::max(epoch_, in.first_go_epoch))
    latched_ = Mode::normal;

  ModeVerdict verdict;
  // At rest, a silent component that only slows the motion is still reported. no_go: only a newer
  // Go is missing.
  verdict.causes = fault | stop | hold | waiting;
  if (latched_ == Mode::hold && verdict.causes == 0) verdict.causes = bit(Cause::no_go);
  verdict.causes |= latched_ == Mode::normal ? slow : slow & kSilent;
  // Causes that slow the motion: all of `slow` except a silent supervisor, which lets the running
  // trajectory finish at full speed.
  const bool slower = (slow & ~bit(Cause::supervisor_silent)) != 0;
  verdict.mode = latched_ != Mode::normal ? latched_ : slower ? Mode::slow : Mode::normal;
  return verdict;
}

Cause worst_of(std::uint32_t causes) {
  constexpr Cause kOrder[] = {Cause::limit_violation,
                              Cause::tracking_error,
                              Cause::drive_not_enabled,
                              Cause::robot_state_silent,
                              Cause::clamped,
                              Cause::contact,
                              Cause::stop_unproven,
                              Cause::human_state_silent,
                              Cause::unlocalised,
                              Cause::blind,
                              Cause::forecast_collision,
                              Cause::separation,
                              Cause::human_unknown,
                              Cause::forecast_silent,
                              Cause::cycle_late,
                              Cause::supervisor_silent,
                              Cause::awaits_person,
                              Cause::no_go,
                              Cause::attention_silent,
                              Cause::attention_slow,
                              Cause::wall,
                              Cause::cost_ahead,
                              Cause::override_slow};
  for (Cause cause : kOrder)
    if (causes & bit(cause)) return cause;
  return Cause::none;
}

}  // namespace handsel::trajectory_controller
