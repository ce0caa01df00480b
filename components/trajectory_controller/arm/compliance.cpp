#include "components/trajectory_controller/arm/compliance.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

namespace {

constexpr int kEvery = 10;  // [cycles] between choices of how to move

}  // namespace

Compliance::Compliance(const ComplianceSettings& settings, const RobotModel& robot,
                       std::size_t joints, ArmMotion& arm)
    : settings_(settings),
      robot_(robot),
      joints_(joints),
      arm_(arm),
      from_(Vector::Zero(robot.dof())),
      away_(from_),
      retreat_velocity_(from_),
      one_axis_(from_) {
  robot_.forward(from_, links_);
  link_twists(robot_, one_axis_, links_, twists_);
}

/// How the axes move the point nearest to a person straight away from that person.
void Compliance::aim_away(const ComplianceInputs& in) noexcept {
  constexpr double kMinLever = 0.05;  // [m]
  away_.setZero();
  retreat_velocity_.setZero();
  const Vector3 direction = in.nearest.on_robot - in.nearest.on_person;
  if (in.nearest.link < 0 || !(direction.norm() > 1e-6)) return;
  const auto link = static_cast<std::size_t>(in.nearest.link);
  const Pose& T_world_base = in.inputs.robot.state().T_world_base;
  const Vector3 toward = T_world_base.linear().transpose() * direction.normalized();
  robot_.forward(in.set_points.sent().position, links_);
  const Vector3 p_base = T_world_base.inverse() * in.nearest.on_robot;
  const Vector3 lever = p_base - links_[link].translation();
  for (std::size_t i = 0; i < joints_; ++i) {
    const int axis = arm_.movers().axes()[i];
    one_axis_.setZero();
    one_axis_[axis] = 1.0;
    link_twists(robot_, one_axis_, links_, twists_);
    const LinkTwist& twist = twists_[link];
    away_[axis] = (twist.linear + twist.angular.cross(lever)).dot(toward);
  }
  const double max_lever = away_.cwiseAbs().maxCoeff();
  away_ *= max_lever > kMinLever ? 1.0 / max_lever : 0.0;
  retreat_velocity_ = settings_.speed * away_;
}

/// Each new demand for rest is answered by rest first; a push that lasts then moves the arm again.
bool Compliance::waits_for_rest(const ComplianceInputs& in) noexcept {
  constexpr std::uint32_t kHeld = 1U;  // Hold or Stop itself: the bit of no cause
  constexpr std::uint32_t kSilence =
      bit(Cause::robot_state_silent) | bit(Cause::human_state_silent);
  constexpr std::uint32_t kDemands =
      kSilence | bit(Cause::drive_not_enabled) | bit(Cause::awaits_person);
  // A contact ends the permission as well, so the word of the supervisor counts.
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
  if (!in.allowed) return Wish::none;
  if (!waits && in.contact.pushed() && !silent) return Wish::comply;
  const bool retreats = in.verdict.mode < Mode::hold && settings_.retreat_reach > 0.0 &&
                        in.recoils && in.nearest.link >= 0;
  return retreats ? Wish::retreat : Wish::none;
}

/// Sets an axis in motion by a ratio of the largest speed, within `reach` of where it began.
void Compliance::move(int axis, double ratio, double reach) noexcept {
  constexpr double kAhead = 0.5;  // [s] of motion a target lies ahead
  AxisLimits limits = limits_of(robot_.comfort_limits(), axis);
  limits.velocity = std::clamp(settings_.speed * std::abs(ratio), 1e-3, limits.velocity);
  const Axis& bounds = robot_.axes()[static_cast<std::size_t>(axis)];
  const double now = arm_.movers()[axis].state().position;
  const double wanted = now + std::copysign(kAhead * limits.velocity, ratio);
  double target = std::clamp(wanted, from_[axis] - reach, from_[axis] + reach);
  if (bounds.lower < bounds.upper) target = std::clamp(target, bounds.lower, bounds.upper);
  arm_.movers().go_to(axis, target, limits);
}

void Compliance::step(const ComplianceInputs& in) noexcept {
  constexpr double kMinFactor = 0.1;  // that the guard must allow
  wish_ = find_wish(in);
  const bool chooses = in.cycle % kEvery == 0;
  if (wish_ == Wish::retreat && chooses) aim_away(in);
  const bool may_retreat = wish_ == Wish::retreat && in.retreat_factor >= kMinFactor;
  const double factor = may_retreat ? in.retreat_factor : 0.0;
  const bool pushed = wish_ == Wish::comply;
  const bool wanted = pushed || factor > 0.0;
  if (wanted && !moving_ && in.set_points.at_rest()) {
    from_ = in.set_points.sent().position;
    moving_ = true;
  }
  if (!moving_) return;
  const bool arm_at_rest = arm_.state() == ArmState::at_rest;
  const double reach = pushed ? settings_.reach : settings_.retreat_reach;
  bool resting = true;
  for (std::size_t i = 0; i < joints_; ++i) {
    const int axis = arm_.movers().axes()[i];
    const double push = pushed ? in.contact.push(i) : 0.0;
    const double beyond = std::abs(push) / settings_.torque - 1.0;
    const double ratio =
        pushed ? std::copysign(std::clamp(beyond, 0.0, 1.0), push) : factor * away_[axis];
    if (arm_at_rest && ratio == 0.0) {
      if (!arm_.movers()[axis].at_rest()) arm_.movers().stop(axis);
    } else if (arm_at_rest && chooses) {
      move(axis, ratio, reach);
    }
    resting = resting && arm_.movers()[axis].at_rest();
  }
  if (!wanted && resting) moving_ = false;
}

}  // namespace handsel::trajectory_controller
