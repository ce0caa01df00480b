// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/output/output_check.hpp"

#include <algorithm>
#include <utility>

namespace handsel::trajectory_controller {

namespace {

/// Parts to stop.
struct Stops {
  bool arm{}, hand{}, head{};
};

/// Stops the given parts, each axis by itself, from the last set-point sent.
void stop(Stops stops, MovingParts parts, double period, SetPoints& set_points) noexcept {
  const MotionState3& sent = set_points.sent();
  if (stops.arm) {
    parts.arm.stop_from(sent);
    parts.arm.movers().step(period, set_points.next());
  }
  if (stops.hand) parts.hands.stop_from(sent, set_points.next());
  if (stops.head) {
    parts.head.stop_from(sent);
    parts.head.step(period, set_points.next());
  }
}

}  // namespace

OutputCheck::OutputCheck(const OutputCheckSettings& settings, const RobotModel& robot,
                         const AxisGroups& groups, StopProof& proof, StopSpace& stop_space)
    : settings_(settings), robot_(robot), groups_(groups), proof_(proof), stop_space_(stop_space) {}

void OutputCheck::step(const OutputCheckInputs& in, MovingParts parts,
                       SetPoints& set_points) noexcept {
  check_limits(parts, set_points);
  // A stop that replaces the set-point was checked for observation with the set-point before.
  if (check_stop(in, parts, set_points)) check_observed(in, parts, set_points);
}

void OutputCheck::check_limits(MovingParts parts, SetPoints& set_points) noexcept {
  Stops stops;
  const MotionState3 &sent = set_points.sent(), &next = set_points.next();
  for (Eigen::Index i = 0; i < next.position.size(); ++i) {
    if (acceptable(sent, next, i, robot_.guard_limits(), settings_.period)) continue;
    const int axis = static_cast<int>(i);
    const bool of_arm = parts.arm.movers().moved()[static_cast<std::size_t>(axis)] != 0;
    (of_arm ? stops.arm : groups_.part(axis) == Part::hand ? stops.hand : stops.head) = true;
  }
  if (!stops.arm && !stops.hand && !stops.head) return;
  limit_violation_ = true;
  if (stops.arm && parts.arm.active()) parts.arm.interrupt_path(false);
  stop(stops, parts, settings_.period, set_points);
}

/// Sends no set-point that moves the robot without a checked stop after it; otherwise sends the
/// next set-point of the last checked stop. Returns whether the set-point itself is sent.
bool OutputCheck::check_stop(const OutputCheckInputs& in, MovingParts parts,
                             SetPoints& set_points) noexcept {
  if (shown_cycles_ > 0) --shown_cycles_;
  const bool proven =
      proof_.check(set_points.next(), in.people, in.T_world_base, in.age, in.payload);
  if (proven || in.moves_nothing) return true;
  ++unproven_;
  const bool running = parts.arm.running();
  failed_rejoins_ = shown_cycles_ > 0 ? failed_rejoins_ + (running ? 1 : 0) : 0;
  shown_cycles_ = static_cast<int>(settings_.shown_time / settings_.period);
  if (running && failed_rejoins_ > settings_.max_rejoins)
    parts.arm.interrupt_path(false);  // the planner finds another path
  else if (running)
    parts.arm.interrupt_path(true);
  const Stops stops{set_points.any_moves(parts.arm.movers().axes()),
                    set_points.any_moves(parts.hands.axes()), set_points.any_moves(groups_.head())};
  stop(stops, parts, settings_.period, set_points);
  return false;
}

/// Sends no set-point whose stop would end where no live source observes. Complying with a push is
/// allowed, as the person who pushes is there. Fingers alone are no reason: Hold stops them.
void OutputCheck::check_observed(const OutputCheckInputs& in, MovingParts parts,
                                 SetPoints& set_points) noexcept {
  if (!proof_.moving() && in.cycle % settings_.blind_cycles != 0) return;
  const Vector& position = set_points.next().position;
  blind_ = !stop_space_.observes_stops(position, in.T_world_base, in.age);
  if (!blind_ || !in.follows || in.moves_nothing || settings_.dry_run) return;
  if (in.complying) return;
  const Stops stops{set_points.any_moves(parts.arm.movers().axes()), false,
                    set_points.any_moves(groups_.head())};
  if (stops.arm && parts.arm.running()) parts.arm.interrupt_path(true);
  stop(stops, parts, settings_.period, set_points);
}

}  // namespace handsel::trajectory_controller
