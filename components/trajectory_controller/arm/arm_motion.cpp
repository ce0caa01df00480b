// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/arm/arm_motion.hpp"

#include <algorithm>
#include <utility>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "components/trajectory_controller/arm/command_check.hpp"

namespace handsel::trajectory_controller {

namespace {

PathLimits path_limits(const RobotModel& robot, const std::vector<std::uint32_t>& axes) {
  const auto count = static_cast<Eigen::Index>(axes.size());
  PathLimits out{limits_of_axes(robot.guard_limits(), axes), Vector::Zero(count), {}};
  out.upper = out.lower;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    out.lower[static_cast<Eigen::Index>(i)] = robot.axes()[axes[i]].lower;
    out.upper[static_cast<Eigen::Index>(i)] = robot.axes()[axes[i]].upper;
  }
  return out;
}

bool is_in_motion(const MotionState3& set_point, Eigen::Index axis) noexcept {
  return set_point.velocity[axis] != 0.0 || set_point.acceleration[axis] != 0.0;
}

/// Returns the state of some axes in a set-point of all axes.
MotionState3 state_of(const MotionState3& set_point, const std::vector<std::uint32_t>& axes) {
  MotionState3 part = rest_state(Vector::Zero(static_cast<Eigen::Index>(axes.size())));
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    part.position[k] = set_point.position[axes[i]];
    part.velocity[k] = set_point.velocity[axes[i]];
    part.acceleration[k] = set_point.acceleration[axes[i]];
  }
  return part;
}

PathPiece piece_of(const TrajectoryCommand& command, double begin, double offset) {
  return {command.id, begin, offset, command.attachment, command.allowed_contacts};
}

}  // namespace

ArmMotion::ArmMotion(const ArmSettings& settings, const RobotModel& robot,
                     const std::vector<int>& axes)
    : settings_(settings),
      robot_(robot),
      movers_(robot, axes),
      runner_({settings.period, settings.join_time, settings.rejoin_time, settings.rejoin_tries,
               settings.alike_distance, settings.alike_ratio}) {}

bool ArmMotion::joins(const TrajectoryCommand& command) const noexcept {
  const bool on_path = running() && !runner_.finished();
  if (!on_path) return state_ == ArmState::stopping;
  return !runner_.standing() || command.switch_at > 0;
}

std::string ArmMotion::accept(const TrajectoryCommand& command, const MotionState3& sent) {
  std::string reason = joins(command) ? switch_to(command, sent) : start(command, sent);
  if (!reason.empty()) return reason;
  motion_ = MotionState::running;
  goal_ = PathGoal::end;
  state_ = ArmState::running;
  return {};
}

std::string ArmMotion::start(const TrajectoryCommand& command, const MotionState3& sent) {
  movers_.drop_further_axes();
  for (const int axis : movers_.axes())
    if (is_in_motion(sent, axis)) return "the arm is still in motion";
  const StartReach reach{settings_.start_tolerance, settings_.switch_reach};
  std::string reason = why_not_from(sent, command, robot_, reach);
  if (!reason.empty()) return reason;
  const MotionState3 here = state_of(sent, command.axes);
  const MotionState3 there = rest_state(command.trajectory.at(0.0).position);
  Trajectory path = command.trajectory;
  double bridged = 0.0;
  constexpr double kSame = 1e-6;
  const bool is_there = (here.position - there.position).cwiseAbs().maxCoeff() <= kSame;
  if (!is_there || !here.velocity.isZero(0.0) || !here.acceleration.isZero(0.0)) {
    Solution bridge = solve(here, there, limits_of_axes(robot_.comfort_limits(), command.axes));
    if (!bridge.ok()) return "no motion to its start: " + bridge.reason;
    path = std::move(bridge.trajectory);
    bridged = path.duration();
    append(path, command.trajectory);
  } else {
    for (std::size_t i = 0; i < path.axes.size(); ++i)
      path.axes[i].start = {here.position[static_cast<Eigen::Index>(i)], 0.0, 0.0};
  }
  reason = runner_.start(path, path_limits(robot_, command.axes));
  if (!reason.empty()) return reason;
  movers_.set_further_axes(command.axes);
  rest_at(sent.position);
  queue_.restart(piece_of(command, 0.0, bridged));
  path_axes_ = command.axes;
  sample_ = runner_.state();
  return {};
}

std::string ArmMotion::switch_to(const TrajectoryCommand& command, const MotionState3& sent) {
  if (command.axes != path_axes_)
    return "it moves other axes than trajectory " + std::to_string(queue_.current().id) +
           ", which runs";
  if (state_ == ArmState::stopping) return switch_from_stop(command, sent);
  const double before = runner_.time();
  double leave = before;
  if (command.switch_at > 0) {
    const double wanted = queue_.last().offset + command.switch_at;
    leave = std::max(leave, std::min(wanted, runner_.duration()));
  }
  if (leave > before && queue_.full())
    return std::to_string(CommandQueue::kMaxWaiting) + " trajectories wait already";
  const bool before_end = leave < runner_.duration();
  const double reach = before_end ? settings_.switch_reach : settings_.start_tolerance;
  std::string reason = runner_.switch_at(leave, command.trajectory, reach);
  if (!reason.empty()) return reason;
  const PathPiece piece = piece_of(command, runner_.switched_at(), runner_.offset());
  queue_.switch_to(piece, leave, runner_.time() - before);
  queue_.find(runner_.time());
  return {};
}

std::string ArmMotion::switch_from_stop(const TrajectoryCommand& command,
                                        const MotionState3& sent) {
  for (int axis : movers_.axes()) {
    const auto found =
        std::find(path_axes_.begin(), path_axes_.end(), static_cast<std::uint32_t>(axis));
    if (found == path_axes_.end() && sent.velocity[axis] != 0.0)
      return "axis " + robot_.axes()[static_cast<std::size_t>(axis)].name +
             ", which it does not move, is still in motion";
  }
  std::string reason =
      runner_.start_from(state_of(sent, path_axes_), command.trajectory, settings_.switch_reach);
  if (!reason.empty()) return reason;
  queue_.restart(piece_of(command, 0.0, runner_.offset()));
  return {};
}

void ArmMotion::cancel() noexcept {
  goal_ = running() ? PathGoal::stop : PathGoal::end;
  motion_ = MotionState::stopped;
}

void ArmMotion::rest_at(const Vector& position) noexcept {
  movers_.reset(position);
  state_ = ArmState::at_rest;
}

void ArmMotion::stop_from(const MotionState3& sent) noexcept {
  movers_.stop_from(sent);
  state_ = ArmState::stopping;
}

void ArmMotion::interrupt_path(bool rejoin) noexcept {
  if (!rejoin) {
    motion_ = MotionState::stopped;
    if (goal_ == PathGoal::rejoin) goal_ = PathGoal::end;
  } else if (goal_ != PathGoal::stop) {
    goal_ = PathGoal::rejoin;
  }
}

bool ArmMotion::rejoin(const MotionState3& sent) noexcept {
  for (std::size_t i = 0; i < path_axes_.size(); ++i)
    sample_.position[static_cast<Eigen::Index>(i)] = sent.position[path_axes_[i]];
  sample_.velocity.setZero();
  sample_.acceleration.setZero();
  goal_ = PathGoal::end;
  if (!runner_.rejoin(sample_)) {
    interrupt_path(false);
    return false;
  }
  queue_.shift(runner_.rejoin_shift());
  state_ = ArmState::running;
  runner_.begin_with(0.0);
  return true;
}

void ArmMotion::step(ArmOrder order, double wanted, SetPoints& set_points) noexcept {
  MotionState3& next = set_points.next();
  // Hands and head have already adopted the positions at which their axes came to rest.
  if (state_ == ArmState::at_rest && goal_ != PathGoal::rejoin) movers_.drop_further_axes();
  if (running()) {
    if (order == ArmOrder::stop) {
      interrupt_path(false);
      stop_from(set_points.sent());
    } else if (order == ArmOrder::leave || !runner_.step(wanted)) {
      interrupt_path(true);
      stop_from(set_points.sent());
    } else {
      write_path(next);
    }
  }
  bool resting = true;
  for (int axis : movers_.axes()) {
    const auto found =
        std::find(path_axes_.begin(), path_axes_.end(), static_cast<std::uint32_t>(axis));
    const bool on_path = running() && found != path_axes_.end();
    const bool rests = movers_[axis].at_rest() && !set_points.moves(axis);
    if (on_path || (state_ == ArmState::at_rest && rests)) continue;
    const bool at_rest = movers_.step(axis, settings_.period, next);
    resting = resting && at_rest;
  }
  if (state_ == ArmState::stopping && resting) state_ = ArmState::at_rest;
}

/// Writes the set-point of the path after its step; at the end of the path the arm is at rest.
void ArmMotion::write_path(MotionState3& next) noexcept {
  queue_.find(runner_.time());
  const MotionState3& state = runner_.state();
  const bool finished = runner_.finished();
  for (std::size_t i = 0; i < path_axes_.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(path_axes_[i]);
    const auto k = static_cast<Eigen::Index>(i);
    next.position[axis] = state.position[k];
    next.velocity[axis] = finished ? 0.0 : state.velocity[k];
    next.acceleration[axis] = finished ? 0.0 : state.acceleration[k];
    movers_.reset(static_cast<int>(axis), next.position[axis]);
  }
  if (finished) {
    state_ = ArmState::at_rest;
    const bool to_end = goal_ != PathGoal::stop && motion_ == MotionState::running;
    if (to_end) motion_ = MotionState::finished;
  } else if (goal_ == PathGoal::stop && runner_.standing()) {
    state_ = ArmState::at_rest;
  }
}

const MotionState3& ArmMotion::path_at(double time) noexcept {
  runner_.observe(time, sample_);
  return sample_;
}

std::vector<Vector> positions_ahead(ArmMotion& arm, const Vector& q) {
  constexpr int kSamples = 8;
  if (!arm.running()) return {};
  std::vector<Vector> ahead(kSamples, q);
  const std::vector<std::uint32_t>& axes = arm.path_axes();
  const double now = arm.path().time(), rest = arm.path().duration() - now;
  for (int k = 0; k < kSamples; ++k) {
    const MotionState3& state = arm.path_at(now + rest * (k + 1) / kSamples);
    for (std::size_t i = 0; i < axes.size(); ++i)
      ahead[static_cast<std::size_t>(k)][axes[i]] = state.position[static_cast<Eigen::Index>(i)];
  }
  return ahead;
}

}  // namespace handsel::trajectory_controller
