// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/arm/compliance.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

Compliance::Compliance(const ComplianceSettings& settings, const RobotModel& robot,
                       std::size_t joints, ArmMotion& arm)
    : settings_(settings),
      robot_(robot),
      joints_(joints),
      arm_(arm),
      from_(Vector::Zero(robot.dof())),
      retreat_velocity_(from_),
      one_axis_(from_),
      hessian_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(joints),
                                     static_cast<Eigen::Index>(joints))),
      gradient_(Vector::Zero(static_cast<Eigen::Index>(joints))),
      solver_(static_cast<Eigen::Index>(joints)) {
  robot_.forward(from_, links_);
  link_twists(robot_, one_axis_, links_, twists_);
  effects_.assign(links_.size(), Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(joints)));
}

/// Chooses the velocity that moves the links near a person straight away from that person, as far
/// as the axes can (damped least squares), but not downward, toward the work surface. Nearer links
/// weigh more. The guard allows only links that clearly retreat to move near a person, so a
/// velocity chosen for the nearest point alone would be refused.
void Compliance::aim_away(const ComplianceInputs& in) noexcept {
  retreat_velocity_.setZero();
  if (in.nearest.link < 0) return;
  const Pose T_base_world = in.inputs.robot.state().T_world_base.inverse();
  const Vector3 p_person = T_base_world * in.nearest.on_person;
  const Vector3 up = T_base_world.linear().col(2);
  robot_.forward(in.set_points.sent().position, links_);
  hessian_.setIdentity();
  hessian_ *= settings_.retreat_damping;
  gradient_.setZero();
  for (std::size_t i = 0; i < joints_; ++i) {
    one_axis_.setZero();
    one_axis_[arm_.movers().axes()[i]] = 1.0;
    link_twists(robot_, one_axis_, links_, twists_);
    for (std::size_t link = 0; link < links_.size(); ++link)
      effects_[link].col(static_cast<Eigen::Index>(i)) = twists_[link].linear;
  }
  for (std::size_t link = 0; link < links_.size(); ++link) {
    Vector3 away = links_[link].translation() - p_person;
    away -= std::min(0.0, away.dot(up)) * up;
    const double distance = away.norm(), lever = effects_[link].norm();
    if (distance > settings_.retreat_range || distance < 1e-6 || lever < 1e-6) continue;
    const double weight = 1.0 - distance / settings_.retreat_range;
    hessian_.noalias() += weight * effects_[link].transpose().lazyProduct(effects_[link]);
    gradient_.noalias() += weight * lever / distance * effects_[link].transpose() * away;
  }
  solver_.compute(hessian_);
  solver_.solveInPlace(gradient_);
  const double largest = gradient_.cwiseAbs().maxCoeff();
  if (!(largest > 1e-6)) return;
  for (std::size_t i = 0; i < joints_; ++i)
    retreat_velocity_[arm_.movers().axes()[i]] =
        settings_.retreat_speed * gradient_[static_cast<Eigen::Index>(i)] / largest;
}

/// Returns whether the arm has to come to rest first: each new demand for rest is met before a push
/// that lasts moves the arm again.
bool Compliance::waits_for_rest(const ComplianceInputs& in) noexcept {
  constexpr std::uint32_t kHeld = 1U;  // mode Hold or Stop itself; the bit belongs to no cause
  constexpr std::uint32_t kSilence =
      bit(Cause::robot_state_silent) | bit(Cause::human_state_silent);
  constexpr std::uint32_t kDemands =
      kSilence | bit(Cause::drive_not_enabled) | bit(Cause::awaits_person);
  // A contact revokes the permission as well, so the permission of the supervisor decides.
  const bool permitted = in.inputs.permission.gate().allowed();
  const std::uint32_t always = permitted ? kHeld : kHeld | bit(Cause::no_go);
  const bool held = in.verdict.mode >= Mode::hold;
  const std::uint32_t demands = held ? always | (in.verdict.causes & kDemands) : 0U;
  if ((demands & ~demands_) != 0) waits_for_rest_ = true;
  demands_ = demands;
  if (in.set_points.at_rest()) waits_for_rest_ = false;
  return waits_for_rest_;
}

Compliance::Wish Compliance::find_wish(const ComplianceInputs& in) noexcept {
  const bool waits = waits_for_rest(in);
  const bool silent = (in.verdict.causes & bit(Cause::robot_state_silent)) != 0;
  if (in.may_comply && !waits && in.contact.pushed() && !silent) return Wish::comply;
  const bool retreats = in.may_retreat && in.verdict.mode < Mode::hold &&
                        settings_.retreat_reach > 0.0 && in.nearest.link >= 0;
  return retreats ? Wish::retreat : Wish::none;
}

/// Moves an axis at `speed` [rad/s], within `reach` [rad] of where the motion of the arm began.
void Compliance::move(int axis, double speed, double reach) noexcept {
  AxisLimits limits = limits_of(robot_.comfort_limits(), axis);
  limits.velocity = std::clamp(std::abs(speed), 1e-3, limits.velocity);
  const Axis& bounds = robot_.axes()[static_cast<std::size_t>(axis)];
  const double now = arm_.movers()[axis].state().position;
  const double wanted = now + std::copysign(settings_.lead * limits.velocity, speed);
  double target = std::clamp(wanted, from_[axis] - reach, from_[axis] + reach);
  if (bounds.lower < bounds.upper) target = std::clamp(target, bounds.lower, bounds.upper);
  arm_.movers().go_to(axis, target, limits);
}

void Compliance::step(const ComplianceInputs& in) noexcept {
  wish_ = find_wish(in);
  const bool chooses = in.cycle % settings_.aim_cycles == 0;
  if (wish_ == Wish::retreat && chooses) aim_away(in);
  const bool may_retreat =
      wish_ == Wish::retreat && in.retreat_factor >= settings_.retreat_min_factor;
  const double factor = may_retreat ? in.retreat_factor : 0.0;
  const bool pushed = wish_ == Wish::comply;
  const bool wanted = pushed || factor > 0.0;
  const bool begins = wish_ == Wish::retreat || in.set_points.at_rest();
  if (wanted && !moving_ && begins) {
    from_ = in.set_points.sent().position;
    moving_ = true;
  }
  if (!moving_) return;
  // A retreat takes over from the stop with which the arm switches off its path.
  const bool free = arm_.state() == ArmState::at_rest || wish_ == Wish::retreat;
  const double reach = pushed ? settings_.reach : settings_.retreat_reach;
  bool resting = true;
  for (std::size_t i = 0; i < joints_; ++i) {
    const int axis = arm_.movers().axes()[i];
    const double push = pushed ? in.contact.push(i) : 0.0;
    const double beyond = std::abs(push) / settings_.torque - 1.0;
    const double speed = pushed
                             ? settings_.speed * std::copysign(std::clamp(beyond, 0.0, 1.0), push)
                             : factor * retreat_velocity_[axis];
    if (free && speed == 0.0) {
      if (!arm_.movers()[axis].at_rest()) arm_.movers().stop(axis);
    } else if (free && chooses) {
      move(axis, speed, reach);
    }
    resting = resting && arm_.movers()[axis].at_rest();
  }
  if (!wanted && resting) moving_ = false;
}

}  // namespace handsel::trajectory_controller
