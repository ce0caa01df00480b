// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/lookahead.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/edit.hpp"

namespace handsel::trajectory_controller {

Lookahead::Lookahead(const LookaheadSettings& settings, const RobotModel& robot,
                     const StopProof& proof, StopSpace& stop_space,
                     const std::vector<int>& finger_axes)
    : settings_(settings),
      robot_(robot),
      proof_(proof),
      stop_space_(stop_space),
      finger_axes_(finger_axes),
      capsules_(robot_capsules(robot)),
      reach_limit_(proof),
      rise_(settings.rise),
      motion_(rest_state(Vector::Zero(robot.dof()))),
      finger_speeds_(motion_.position) {
  robot_.forward(motion_.position, links_);
  link_twists(robot_, motion_.velocity, links_, twists_);
}

bool Lookahead::step(const LookaheadInputs& in, std::uint64_t cycle) noexcept {
  set_finger_speeds(in.set_point);
  const bool running = in.arm.running();
  if (!running || in.arm.path().finished()) {
    now_ = near_ = far_ = {};
    rise_.rest();
    now_.uncovered = in.uncovered;
    // At rest only the distance, the end of a handover and a possible retreat matter.
    if (cycle % (in.retreat != nullptr ? settings_.retreat_cycles : settings_.rest_cycles) != 0) {
      verdict_ = now_;
      if (in.retreat != nullptr) keep_retreat();
      return false;
    }
    motion_.velocity.setZero();
    motion_.acceleration.setZero();
    if (in.retreat != nullptr) motion_.velocity = *in.retreat;
  }
  // Every other cycle evaluates the present state on the path, the cycles between one of two later
  // states in turn; after new observations of people, the present state.
  turn_ = new_people_ || !running ? 0 : (turn_ + 1) % 4;
  const bool here = turn_ % 2 == 0;
  if (here)
    evaluate(0.0, in, now_);
  else if (turn_ == 1)
    evaluate(settings_.look_ahead, in, near_);
  else
    evaluate(settings_.look_far_ahead, in, far_);
  if (here) nearest_ = now_;
  new_people_ = false;
  merge();
  if (running) limit_rise();
  retreat_ = {verdict_.forward, verdict_.separation, verdict_.wall};
  return here;
}

/// Keeps the limit of a retreat and its causes between two evaluations.
void Lookahead::keep_retreat() noexcept {
  verdict_.forward = retreat_.factor;
  verdict_.separation = retreat_.people;
  verdict_.wall = retreat_.wall;
}

void Lookahead::evaluate_all(const LookaheadInputs& in, bool from_rest) noexcept {
  if (from_rest) rise_.restart();
  evaluate(0.0, in, now_);
  evaluate(settings_.look_ahead, in, near_);
  evaluate(settings_.look_far_ahead, in, far_);
  merge();
  rise_.note(verdict_.forward);
}

void Lookahead::forbid_all() noexcept {
  now_ = near_ = far_ = {};
  now_.forward = near_.forward = far_.forward = 0.0;
  merge();
  rise_.forbid();
}

void Lookahead::set_finger_speeds(const MotionState3& set_point) noexcept {
  const double delay = proof_.settings().robot_side_delay;
  for (int axis : finger_axes_)
    finger_speeds_[axis] =
        std::abs(set_point.velocity[axis]) + delay * std::abs(set_point.acceleration[axis]);
}

void Lookahead::merge() noexcept {
  verdict_ = now_;
  for (const GuardVerdict* ahead : {&near_, &far_}) {
    verdict_.forward = std::min(verdict_.forward, ahead->forward);
    verdict_.backward = std::max(verdict_.backward, ahead->backward);
    verdict_.separation = verdict_.separation || ahead->separation;
    verdict_.wall = verdict_.wall || ahead->wall;
    verdict_.view = std::min(verdict_.view, ahead->view);
  }
}

void Lookahead::limit_rise() noexcept {
  const SpeedLimit limit = rise_.next({verdict_.forward, verdict_.separation, verdict_.wall});
  verdict_.forward = limit.factor;
  verdict_.separation = limit.people;
  verdict_.wall = limit.wall;
}

/// Sets the motion along the path `ahead` [s] of the present state; at rest keeps the motion set
/// before.
void Lookahead::set_motion(double ahead, const LookaheadInputs& in) noexcept {
  motion_.position = in.set_point.position;
  if (!in.arm.running()) return;
  motion_.velocity.setZero();
  motion_.acceleration.setZero();
  const double factor = in.arm.path().factor(),
               speed = std::max(std::abs(factor), settings_.min_factor);
  const double time =
      in.arm.path().time() + ahead * (factor < -settings_.back_min_factor ? -speed : speed);
  const MotionState3& at = in.arm.path_at(time);
  for (std::size_t i = 0; i < in.arm.path_axes().size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(in.arm.path_axes()[i]);
    const auto k = static_cast<Eigen::Index>(i);
    motion_.position[axis] = at.position[k];
    motion_.velocity[axis] = at.velocity[k];
    motion_.acceleration[axis] = at.acceleration[k];
  }
}

void Lookahead::evaluate(double ahead, const LookaheadInputs& in, GuardVerdict& verdict) noexcept {
  set_motion(ahead, in);
  robot_.forward(motion_.position, links_);
  link_twists(robot_, motion_.velocity, links_, twists_);
  const PathMotion motion{&motion_.velocity, &motion_.acceleration, &links_, &twists_};
  const StopTable stop = stop_table(motion, robot_.stop_limits());
  const double factor = in.arm.speed_factor();
  verdict = guard(settings_.guard, {capsules_, motion, stop, in.T_world_base, in.people,
                                    settings_.walls, in.age, factor});
  const ReachQuery query{motion_.position,
                         motion_.velocity,
                         in.set_point.acceleration,
                         finger_speeds_,
                         stop,
                         in.T_world_base,
                         in.ease,
                         in.age,
                         in.payload};
  const double forward = reach_limit_.factor(query, in.people, false);
  verdict.separation = verdict.separation || forward < verdict.forward;
  verdict.forward = std::min(verdict.forward, forward);
  // The stop check of the set-point itself covers the present state.
  verdict.view = 1.0;
  if (in.arm.running() && ahead > 0.0)
    verdict.view = stop_space_.factor(motion_.position, motion_.velocity, in.T_world_base, in.age);
  if (in.may_run_back)
    verdict.backward = std::max(verdict.backward, -reach_limit_.factor(query, in.people, true));
}

bool Lookahead::is_too_fast(double factor) const noexcept {
  const double allowed = factor < 0.0 ? -std::max(now_.backward, near_.backward)
                                      : std::min(now_.forward, near_.forward);
  return std::abs(factor) > settings_.too_fast_ratio * allowed + settings_.too_fast_margin;
}

}  // namespace handsel::trajectory_controller
