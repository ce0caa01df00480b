// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/arm/reference_follower.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

namespace {

constexpr double kDeadBand = 0.002;  // max distance from the target [rad]

}  // namespace

ReferenceFollower::ReferenceFollower(const ReferenceFollowerSettings& settings,
                                     const AxisGroups& groups)
    : settings_(settings),
      groups_(groups),
      reference_(groups.arm(), groups.size(), settings.reference),
      adopted_(Vector::Zero(groups.size())),
      measured_before_(adopted_) {}

bool ReferenceFollower::moves_nothing() const noexcept {
  return apart_ && !settings_.dry_run && reference_.state() == RobotReference::State::resting;
}

/// Returns whether an axis was at rest since the last check.
bool ReferenceFollower::rests(const RobotState& robot, int axis) const noexcept {
  constexpr double kRests = 0.05, kStill = 5e-4;  // [rad/s]; [rad] between two checks
  const bool still = std::abs(robot.position[axis] - measured_before_[axis]) < kStill;
  const bool has_velocity = robot.velocity.size() == robot.position.size();
  return still && (!has_velocity || std::abs(robot.velocity[axis]) < kRests);
}

/// Adopts the measured configuration of an arm at rest once, and again after the arm has moved.
void ReferenceFollower::adopt(const RobotState& robot) noexcept {
  const auto far = [&](int axis) {
    return std::abs(robot.position[axis] - adopted_[axis]) > settings_.reference.bent;
  };
  const std::vector<int>& arm = groups_.arm();
  if (has_adopted_ && !std::any_of(arm.begin(), arm.end(), far)) return;
  adopted_ = robot.position;
  has_adopted_ = true;
}

// Enabled drives move the reference of the robot side to set-points at rest. Set-points at rest at
// the reference move nothing and stay unchanged while the reference moves. If the reference is
// unknown, or follows under a fault, the set-points adopt the configuration at rest once: if they
// followed a sagging arm or a bent finger, the robot would creep.
ReferenceFollower::Target ReferenceFollower::find_target(const RobotState& robot) noexcept {
  const bool joins = robot.mode == DriveMode::enabled && !settings_.dry_run;
  const bool at_reference = moves_nothing();
  const bool reference_moves = reference_.state() == RobotReference::State::moving;
  const bool arm_rests = std::all_of(groups_.arm().begin(), groups_.arm().end(),
                                     [&](int axis) { return rests(robot, axis); });
  measured_before_ = robot.position;
  if (joins && !at_reference && arm_rests && !reference_moves) adopt(robot);
  if (!settings_.dry_run && reference_moves) return Target::none;
  if (at_reference) return Target::reference;
  if (!joins) return Target::measured;
  return has_adopted_ ? Target::adopted : Target::none;
}

void ReferenceFollower::follow(Target target, const RobotState& robot, const std::vector<int>& axes,
                               AxisMovers& movers) const noexcept {
  constexpr double kExact = 1e-12;  // [rad]
  if (target == Target::none) return;
  const Vector& position = target == Target::reference  ? robot.reference.position
                           : target == Target::measured ? robot.position
                                                        : adopted_;
  const double dead_band = target == Target::measured ? kDeadBand : kExact;
  for (int axis : axes) {
    const double wanted = groups_.inside(axis, position[axis]);
    if (std::abs(wanted - movers[axis].target()) > dead_band) movers.go_to(axis, wanted);
  }
}

void ReferenceFollower::step(const ReferenceInputs& in, ArmMotion& arm, AxisMovers& head,
                             Hands& hands) noexcept {
  const RobotState& robot = in.robot.state();
  const bool stale = in.age > settings_.timeout;
  if (stale) reference_.set_stale();
  const bool due = in.cycle % settings_.reference.cycles == 0 && !stale;
  const Vector& set_point = in.set_points.sent().position;
  if (due) reference_.update(robot, set_point, in.robot.follows());
  apart_ = in.fault || !in.robot.follows();
  const bool wanted = settings_.dry_run || apart_;
  if (!wanted) has_adopted_ = false;
  const bool rests = arm.state() == ArmState::at_rest && in.set_points.at_rest();
  if (!wanted || !due || !rests) return;
  const Target target = find_target(robot);
  follow(target, robot, groups_.arm(), arm.movers());
  follow(target, robot, groups_.head(), head);
  // Finger set-points stay where the fingers came to rest: a held object bends them, and a person
  // who also holds the object moves them all the time.
  const bool joins = robot.mode == DriveMode::enabled && !settings_.dry_run;
  hands.follow(robot.position, joins ? settings_.hand_rejoin : kDeadBand);
}

}  // namespace handsel::trajectory_controller
