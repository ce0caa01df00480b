// How fast the path may be run: what the guard and the stop proof say of where it is and where it will be.
#include <algorithm>
#include <cmath>

#include "components/trajectory_controller/controller.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kLeastLook = 0.6;  // speed factor looked ahead with at least: who goes on must also be able to stop
constexpr double kBackward = 0.02;  // it runs back

}  // namespace

void Controller::run_guard(TimePoint now) noexcept {
  for (const Hand& hand : hands_)
    for (int axis : hand.executor.axes())
      finger_speeds_[axis] =
          std::abs(set_point_.velocity[axis]) + settings_.proof.robot_side_delay * std::abs(set_point_.acceleration[axis]);
  if (arm_ != Arm::running || runner_.finished()) {
    verdict_now_ = verdict_near_ = verdict_far_ = {};
    verdict_now_.uncovered = human_seen_.ever && !person_capsules_.covered;
    // At rest only the distance and the end of an exchange are of interest, and whether it may draw back.
    if (cycles_ % (retreating_ ? kYieldEvery : 50) != 0) {
      guard_verdict_ = verdict_now_;
      if (retreating_) guard_verdict_.forward = retreat_share_;
      return;
    }
    full_velocity_.setZero();
    full_acceleration_.setZero();
    if (retreating_) full_velocity_ = settings_.yield_speed * away_;
  }
  // In turn where the path is and where it will be a little later, the one or the other; where it is as soon as people have just been seen.
  turn_ = new_people_ || arm_ != Arm::running ? 0 : (turn_ + 1) % 4;
  const bool here = turn_ % 2 == 0;
  if (here)
    judge_path(0.0, verdict_now_, now);
  else if (turn_ == 1)
    judge_path(settings_.look_ahead, verdict_near_, now);
  else
    judge_path(settings_.look_far_ahead, verdict_far_, now);
  if (here) nearest_ = verdict_now_;
  new_people_ = false;
  merge_verdicts();
  retreat_share_ = guard_verdict_.forward;
  if (here && verdict_now_.exchange_clear && !action_.exchange_engaged && !exchanging_.empty()) {
    exchanging_.clear();
    for (PersonCapsule& capsule : person_capsules_.capsules) capsule.excepted = false;
  }
}

/// A path is judged before its first step; from rest it begins with no more than may be.
void Controller::judge_new_path(TimePoint now) noexcept {
  judge_path(0.0, verdict_now_, now);
  judge_path(settings_.look_ahead, verdict_near_, now);
  judge_path(settings_.look_far_ahead, verdict_far_, now);
  merge_verdicts();
  runner_.begin_with(std::max(0.0, wanted_factor(now)));
}

void Controller::merge_verdicts() noexcept {
  guard_verdict_ = verdict_now_;
  for (const GuardVerdict* ahead : {&verdict_near_, &verdict_far_}) {
    guard_verdict_.forward = std::min(guard_verdict_.forward, ahead->forward);
    guard_verdict_.backward = std::max(guard_verdict_.backward, ahead->backward);
    guard_verdict_.separation = guard_verdict_.separation || ahead->separation;
    guard_verdict_.wall = guard_verdict_.wall || ahead->wall;
    guard_verdict_.view = std::min(guard_verdict_.view, ahead->view);
  }
}

void Controller::judge_path(double ahead, GuardVerdict& verdict, TimePoint now) noexcept {
  posture_ = set_point_.position;
  if (arm_ == Arm::running) {
    full_velocity_.setZero();
    full_acceleration_.setZero();
    const double factor = runner_.factor(), pace = std::max(std::abs(factor), kLeastLook);
    runner_.look(runner_.time() + ahead * (factor < -kBackward ? -pace : pace), path_);
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const auto axis = static_cast<Eigen::Index>(axes_[i]);
      const auto k = static_cast<Eigen::Index>(i);
      posture_[axis] = path_.position[k];
      full_velocity_[axis] = path_.velocity[k];
      full_acceleration_[axis] = path_.acceleration[k];
    }
  }
  robot_->forward(posture_, links_);
  link_twists(*robot_, full_velocity_, links_, twists_);
  const PathMotion motion{&full_velocity_, &full_acceleration_, &links_, &twists_};
  const StopTable stop = stop_table(motion, robot_->stop_limits());
  const double age = std::max(0.0, human_seen_.age(now));
  verdict = guard(settings_.guard,
                  {capsules_, motion, stop, state_.T_world_base, person_capsules_, settings_.walls, age, speed_factor()});
  const ReachQuery query{posture_, full_velocity_, set_point_.acceleration, finger_speeds_, stop, state_.T_world_base, onward_ease(),
                         age,      held_payload()};
  const double forward = reach_limit_.factor(query, person_capsules_, false);
  verdict.separation = verdict.separation || forward < verdict.forward;
  verdict.forward = std::min(verdict.forward, forward);
  // Where the path is now is in the stop of the set-point itself.
  const bool leads_on = arm_ == Arm::running && ahead > 0.0;
  verdict.view = leads_on ? stop_space_.factor(posture_, full_velocity_, state_.T_world_base, age) : 1.0;
  if (advice_.speed_factor < 0.0 || speed_factor() < 0.0)
    verdict.backward = std::max(verdict.backward, -reach_limit_.factor(query, person_capsules_, true));
}

/// In which the stop limits take away the acceleration that still makes the arm faster [s].
double Controller::onward_ease() const noexcept {
  double longest = 0.0;
  for (int axis : arm_axes_) {
    const double onward = std::copysign(1.0, set_point_.velocity[axis]) * set_point_.acceleration[axis];
    longest = std::max(longest, onward / robot_->stop_limits().jerk[axis]);
  }
  return longest;
}

/// Returns whether the arm is faster than the guard allows here and shortly ahead, by more than what the time law lags behind a verdict
/// that changes slowly. What is allowed farther ahead lowers the speed along the path in time; leaving the path for it would begin anew for
/// ever.
bool Controller::too_fast() const noexcept {
  constexpr double kLag = 1.1, kLeast = 0.02;
  const double factor = speed_factor();
  const double allowed =
      factor < 0.0 ? -std::max(verdict_now_.backward, verdict_near_.backward) : std::min(verdict_now_.forward, verdict_near_.forward);
  return std::abs(factor) > kLag * allowed + kLeast;
}

}  // namespace handsel::trajectory_controller
