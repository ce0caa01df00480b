// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/output/status_report.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

namespace {

MotionState reported_motion(const StatusSources& from) {
  return from.commands.refused() ? MotionState::refused : from.arm.motion();
}

/// Returns the time along the reported trajectory, divided by its duration.
double progress(const StatusSources& from) {
  if (reported_motion(from) == MotionState::finished) return 1.0;
  const PathPiece& last = from.arm.queue().last();
  const PathRunner& path = from.arm.path();
  const CommandReport& commands = from.commands;
  const bool known = !commands.refused() && commands.accepted_trajectory() == last.id;
  if (!known || !(path.duration() > last.begin)) return 0.0;
  return std::clamp((path.time() - last.begin) / (path.duration() - last.begin), 0.0, 1.0);
}

const std::string& axis_name(const StatusSources& from, int axis) {
  return from.robot.axes()[static_cast<std::size_t>(axis)].name;
}

std::string why_blind(const StatusSources& from) {
  const int link = from.stop_space.link();
  const std::string name = link < 0 ? "" : from.robot.links()[static_cast<std::size_t>(link)].name;
  return trajectory_controller::why_blind(from.inputs.people.state(), name);
}

/// Returns the reason of Hold, Stop or Fault.
std::string held_reason(const StatusSources& from) {
  const Supervisor& supervisor = from.supervisor;
  const Cause latched = supervisor.latched_cause();
  const RobotState& robot = from.inputs.robot.state();
  const TrackingMonitor& tracking = supervisor.tracking();
  const TrajectoryForecast& forecast = from.inputs.forecast.value;
  std::string reason = std::string(name(supervisor.mode())) + ": " + name(latched);
  if (latched == Cause::cycle_late && !robot.refusal.empty()) reason += ": " + robot.refusal;
  if (latched == Cause::tracking_error && tracking.axis() >= 0)
    reason += ": " + axis_name(from, tracking.axis()) + " was " +
              std::to_string(tracking.distance()) + " from its set-point";
  if (latched == Cause::contact || latched == Cause::clamped)
    reason += ": felt by " + axis_name(from, from.contact.axis());
  if (latched == Cause::forecast_collision && forecast.collides) reason += ": " + forecast.reason;
  if (latched == Cause::blind && supervisor.has(Cause::blind)) reason += ": " + why_blind(from);
  const std::string no_go = from.inputs.permission.reason();
  if (supervisor.has(Cause::awaits_person) && !no_go.empty()) reason += ": " + no_go;
  return reason;
}

std::string reason(const StatusSources& from) {
  const Supervisor& supervisor = from.supervisor;
  const std::string& refusal = from.commands.reason();
  if (!refusal.empty()) {
    if (!supervisor.has(Cause::blind)) return refusal;
    return std::string(name(Cause::blind)) + ": " + why_blind(from) + "; " + refusal;
  }
  if (supervisor.mode() >= Mode::hold) return held_reason(from);
  const Cause cause = worst_of(supervisor.verdict().causes);
  if (cause == Cause::none) return from.dry_run ? "dry run: no set-point is sent" : "";
  std::string out = name(cause);
  if (cause == Cause::blind) out += ": " + why_blind(from);
  if (cause == Cause::attention_slow) out += ": " + from.inputs.advice.value.reason;
  if (cause == Cause::forecast_collision) out += ": " + from.inputs.forecast.value.reason;
  return out;
}

}  // namespace

StatusKey status_key(const StatusSources& from) {
  return {from.supervisor.mode(),     from.inputs.permission.go().epoch,
          from.commands.trajectory(), from.hands.last_command(),
          reported_motion(from),      from.hands.key()};
}

ExecutionStatus make_status(const StatusSources& from) {
  ExecutionStatus s;
  s.robot = from.robot.name();
  s.mode = from.supervisor.mode();
  s.causes = from.supervisor.verdict().causes;
  s.epoch = from.inputs.permission.go().epoch;
  s.trajectory = from.commands.trajectory();
  s.motion = reported_motion(from);
  s.progress = progress(from);
  from.hands.report(s);
  s.reason = reason(from);
  s.cycles = from.cycles;
  s.late_cycles = from.supervisor.late_cycles();
  const LimitRatios& ratios = from.set_points.ratios();
  s.limit_ratio_velocity = ratios.velocity;
  s.limit_ratio_acceleration = ratios.acceleration;
  s.limit_ratio_jerk = ratios.jerk;
  s.separation = from.nearest.distance;
  s.separation_limit = from.nearest.needed;
  s.nearest_on_robot = from.nearest.on_robot;
  s.nearest_on_person = from.nearest.on_person;
  return s;
}

ActiveTrajectory make_active(const StatusSources& from) {
  ActiveTrajectory a;
  const MotionState3& sent = from.set_points.sent();
  const PathPiece& piece = from.arm.queue().current();
  a.robot = from.robot.name();
  a.T_world_base = from.inputs.robot.state().T_world_base;
  a.position = sent.position;
  a.velocity = sent.velocity;
  a.acceleration = sent.acceleration;
  if (!from.hands.has_released(piece.attachment.hand)) a.attachment = piece.attachment;
  if (!from.arm.running()) return a;
  const PathRunner& path = from.arm.path();
  a.trajectory = piece.id;
  a.time = path.time();
  a.speed_factor = std::clamp(path.factor(), -1.0, 1.0);  // clamps rounding errors
  a.axes = from.arm.path_axes();
  a.rest = path.path();
  a.allowed_contacts = piece.allowed_contacts;
  return a;
}

}  // namespace handsel::trajectory_controller
