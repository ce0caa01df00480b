// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/supervisor.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

namespace {

constexpr double kFull = 0.999;  // min speed factor of full speed

}  // namespace

Supervisor::Supervisor(const SupervisorSettings& settings)
    : settings_(settings),
      modes_(settings.timeouts),
      tracking_(settings.tracking_tolerance, settings.tracking_time) {}

void Supervisor::update(const SupervisorInputs& in, TimePoint now) noexcept {
  verdict_ = modes_.update(mode_inputs(in, now));
  if (verdict_.mode < Mode::hold) {
    latched_cause_ = Cause::none;
    return;
  }
  const Cause cause = worst_of(verdict_.causes & ~bit(Cause::no_go));
  if (cause != Cause::none)
    latched_cause_ = cause;
  else if (latched_cause_ == Cause::none)
    latched_cause_ = Cause::no_go;
}

ModeInputs Supervisor::mode_inputs(const SupervisorInputs& in, TimePoint now) noexcept {
  ModeInputs out;
  out.robot_age = in.inputs.robot.age(now);
  out.human_age = in.inputs.people.age(now);
  out.forecast_age = in.inputs.forecast.time.age(now);
  out.attention_age = in.inputs.advice.time.age(now);
  out.go_age = in.inputs.permission.age(now);
  out.running = in.running;
  out.running_for = in.running ? to_seconds(now - started_) : 0.0;
  out.at_rest = in.set_points.at_rest();
  const RobotState& robot = in.inputs.robot.state();
  if (robot.localisation_age > 0)
    out.localisation_age = robot.localisation_age + std::max(0.0, out.robot_age);
  out.drive_enabled = robot.mode == DriveMode::enabled;
  out.set_points_late = out.drive_enabled && !in.inputs.robot.follows();
  const bool follows = in.inputs.robot.follows() && !settings_.dry_run;
  const Vector& set_point = in.set_points.sent().position;
  out.tracking_error =
      tracking_.update(in.arm_axes, robot.position, set_point, follows, settings_.period);
  out.limit_violation = in.limit_violation;
  late_in_a_row_ = in.late ? late_in_a_row_ + 1 : 0;
  if (in.late) ++late_cycles_;
  out.cycle_late = late_in_a_row_ >= settings_.late_limit;
  add_forecast(in, out);

  out.separation_slow = in.guard.separation && in.guard.forward < kFull;
  out.wall_slow = in.guard.wall && in.guard.forward < kFull;
  const bool too_near = in.running && in.guard.too_near;
  too_near_for_ = too_near ? too_near_for_ + settings_.period : 0.0;
  out.separation_stop = too_near_for_ > settings_.stop_persistence;
  // A short push on an arm at rest does no harm.
  out.contact_stop = in.contact != Contact::none && !out.at_rest && !in.complying;
  out.clamped = in.contact == Contact::clamped;
  out.human_unknown = in.inputs.people.uncovered();
  const AttentionAdvice& advice = in.inputs.advice.value;
  out.attention_slow =
      in.running && in.inputs.advice.time.received() && advice.speed_factor < kFull;
  out.cost_slow = in.running && in.cost_factor < kFull;
  out.stop_unproven = in.stop_unproven;
  out.blind = in.blind && in.inputs.people.received();
  out.blind_ahead = in.running && in.guard.view < kFull;
  const Go& go = in.inputs.permission.go();
  const GoGate& gate = in.inputs.permission.gate();
  out.override_slow = go.override_factor < kFull;
  out.go_epoch = go.epoch;
  out.go_allowed = gate.allowed();
  out.first_go_epoch = gate.first_epoch();
  out.awaits_person = gate.awaits_person();
  out.go_acknowledge = go.acknowledge;
  return out;
}

void Supervisor::add_forecast(const SupervisorInputs& in, ModeInputs& out) const noexcept {
  const TrajectoryForecast& forecast = in.inputs.forecast.value;
  if (!in.running || !forecast.collides || forecast.trajectory != in.trajectory) return;
  out.forecast_collision_hold = forecast.time_to_collision < settings_.forecast_hold;
  out.forecast_collision_slow =
      !out.forecast_collision_hold && forecast.time_to_collision < settings_.forecast_slow;
}

}  // namespace handsel::trajectory_controller
