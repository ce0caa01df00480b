// What commands are accepted, and how the path of the arm grows by them.
#include <algorithm>
#include <cmath>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/solve.hpp"
#include "components/trajectory_controller/controller.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kAtRest = 1e-6;
constexpr std::size_t kMostWaiting = 8;
constexpr double kRefusalTold = 0.2;  // [s] while another path runs or is to be rejoined

}  // namespace

KinematicLimits Controller::of_axes(const KinematicLimits& limits, const std::vector<std::uint32_t>& axes) const {
  KinematicLimits part;
  const auto n = static_cast<Eigen::Index>(axes.size());
  part.velocity.resize(n);
  part.acceleration.resize(n);
  part.jerk.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto axis = axes[static_cast<std::size_t>(i)];
    part.velocity[i] = limits.velocity[axis];
    part.acceleration[i] = limits.acceleration[axis];
    part.jerk[i] = limits.jerk[axis];
  }
  return part;
}

PathLimits Controller::path_limits(const std::vector<std::uint32_t>& axes) const {
  PathLimits out{of_axes(robot_->guard_limits(), axes), Vector::Zero(static_cast<Eigen::Index>(axes.size())), {}};
  out.upper = out.lower;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    out.lower[static_cast<Eigen::Index>(i)] = robot_->axes()[axes[i]].lower;
    out.upper[static_cast<Eigen::Index>(i)] = robot_->axes()[axes[i]].upper;
  }
  return out;
}

std::string Controller::why_not_now(const std::string& robot, std::uint64_t epoch, Duration age) const {
  if (robot != robot_->name()) return "it is for robot " + robot + ", this is " + robot_->name();
  if (!ready_) return "the robot's posture is not known yet";
  if (to_seconds(age) > settings_.max_command_age) return "it is " + std::to_string(to_seconds(age)) + " s old";
  if (!go_seen_.ever || epoch != go_.epoch)
    return "its epoch " + std::to_string(epoch) + " is not the one in force, " + std::to_string(go_.epoch);
  if (verdict_.mode >= Mode::stop) return std::string("the controller is in mode ") + name(verdict_.mode) + ": " + name(latched_cause_);
  return {};
}

std::string Controller::why_not(const TrajectoryCommand& command, Duration age) const {
  if (std::string reason = why_not_now(command.robot, command.epoch, age); !reason.empty()) return reason;
  if (command.axes.empty() && command.trajectory.size() == 0) return {};
  if (!std::isfinite(command.switch_at)) return "its switch_at is not a number";
  if (command.trajectory.size() != static_cast<int>(command.axes.size()))
    return "it has " + std::to_string(command.trajectory.size()) + " axes and names " + std::to_string(command.axes.size());
  std::vector<char> used(part_.size(), 0);
  for (std::uint32_t axis : command.axes) {
    if (axis >= part_.size()) return "axis " + std::to_string(axis) + " does not exist";
    if (part_[axis] != Part::arm) return "axis " + robot_->axes()[axis].name + " is not moved by trajectories";
    if (used[axis]++) return "axis " + robot_->axes()[axis].name + " comes twice";
  }
  if (std::string reason = why_not_within(command.trajectory, of_axes(robot_->guard_limits(), command.axes), kLimitTolerance);
      !reason.empty())
    return reason;
  const MotionState3 last = final_state(command.trajectory);
  for (std::size_t i = 0; i < command.axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Axis& axis = robot_->axes()[command.axes[i]];
    if (std::abs(last.velocity[k]) > kAtRest || std::abs(last.acceleration[k]) > kAtRest)
      return "axis " + axis.name + " does not end at rest";
    const AxisExtremes reach = extremes(command.trajectory.axes[i]);
    if (reach.lowest < axis.lower - kAtRest || reach.highest > axis.upper + kAtRest)
      return "axis " + axis.name + " would reach [" + std::to_string(reach.lowest) + ", " + std::to_string(reach.highest) +
             "] rad, outside its bounds";
  }
  return {};
}

std::string Controller::why_not_from_rest(const TrajectoryCommand& command) const {
  const MotionState3 first = command.trajectory.at(0.0);
  for (std::size_t i = 0; i < command.axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Axis& axis = robot_->axes()[command.axes[i]];
    if (std::abs(first.velocity[k]) > kAtRest || std::abs(first.acceleration[k]) > kAtRest)
      return "axis " + axis.name + " does not start at rest";
    const double off = std::abs(first.position[k] - set_point_.position[command.axes[i]]);
    if (!(off <= settings_.start_tolerance)) return "axis " + axis.name + " starts " + std::to_string(off) + " rad from the set-point";
  }
  return {};
}

std::string Controller::refuse(const TrajectoryCommand& command, const std::string& reason) {
  refused_ = true;
  refused_trajectory_ = command.id;
  const bool path_goes_on = arm_ == Arm::running || rejoin_;
  refused_for_ = path_goes_on ? static_cast<int>(kRefusalTold / settings_.period) : 0;
  refusal_ = "trajectory " + std::to_string(command.id) + ": " + reason;
  return reason;
}

void Controller::take(const TrajectoryCommand& command, double begin, double offset) {
  pieces_.push_back({command.id, begin, offset, command.attachment, command.allowed_contacts});
  accepted_trajectory_ = command.id;
  motion_ = MotionState::running;
  cancelled_ = rejoin_ = refused_ = false;
  refused_for_ = 0;
  refusal_.clear();
  arm_ = Arm::running;
}

std::string Controller::accept(const TrajectoryCommand& command, Duration age, TimePoint now) {
  if (command.id != 0 && command.id == accepted_trajectory_) return "it came before; the first one counts";
  if (std::string reason = why_not(command, age); !reason.empty()) return refuse(command, reason);
  if (command.axes.empty()) {
    accepted_trajectory_ = command.id;
    refused_ = false;
    refusal_.clear();
    cancelled_ = arm_ == Arm::running;
    give_up_path();
    return {};
  }
  const bool on_path = arm_ == Arm::running && !runner_.finished();
  std::string reason;
  if (on_path ? !runner_.standing() || command.switch_at > 0 : arm_ == Arm::stopping)
    reason = go_over(command);
  else
    reason = start(command, now);
  if (!reason.empty()) return refuse(command, reason);
  judge_new_path(now);
  return {};
}

/// From rest, beginning with a short motion to its start where that is a little off.
std::string Controller::start(const TrajectoryCommand& command, TimePoint now) {
  for (int axis : arm_axes_)
    if (set_point_.velocity[axis] != 0.0 || set_point_.acceleration[axis] != 0.0) return "the arm is still in motion";
  if (std::string reason = why_not_from_rest(command); !reason.empty()) return reason;
  MotionState3 here = rest_state(Vector::Zero(command.trajectory.size()));
  for (std::size_t i = 0; i < command.axes.size(); ++i) here.position[static_cast<Eigen::Index>(i)] = set_point_.position[command.axes[i]];
  const MotionState3 there = rest_state(command.trajectory.at(0.0).position);
  Trajectory path = command.trajectory;
  double bridged = 0.0;
  constexpr double kSame = 1e-6;
  if ((here.position - there.position).cwiseAbs().maxCoeff() > kSame) {
    Solution bridge = solve(here, there, of_axes(robot_->comfort_limits(), command.axes));
    if (!bridge.ok()) return "no motion to its start: " + bridge.reason;
    path = std::move(bridge.trajectory);
    bridged = path.duration();
    append(path, command.trajectory);
  } else {
    for (std::size_t i = 0; i < path.axes.size(); ++i) path.axes[i].start = {here.position[static_cast<Eigen::Index>(i)], 0.0, 0.0};
  }
  if (std::string why = runner_.start(path, path_limits(command.axes)); !why.empty()) return why;
  stand_arm();
  pieces_.clear();
  current_ = 0;
  take(command, 0.0, bridged);
  axes_ = command.axes;
  path_ = runner_.state();
  started_ = now;
  too_near_for_ = 0.0;
  return {};
}

/// In motion, or to wait in line.
std::string Controller::go_over(const TrajectoryCommand& command) {
  if (command.axes != axes_) return "it moves other axes than trajectory " + std::to_string(piece().id) + ", which runs";
  if (arm_ == Arm::stopping) {
    MotionState3 here = rest_state(Vector::Zero(command.trajectory.size()));
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      here.position[k] = set_point_.position[axes_[i]];
      here.velocity[k] = set_point_.velocity[axes_[i]];
      here.acceleration[k] = set_point_.acceleration[axes_[i]];
    }
    for (int axis : arm_axes_)
      if (std::find(axes_.begin(), axes_.end(), static_cast<std::uint32_t>(axis)) == axes_.end() && set_point_.velocity[axis] != 0.0)
        return "axis " + robot_->axes()[static_cast<std::size_t>(axis)].name + ", which it does not move, is still in motion";
    if (std::string why = runner_.start_from(here, command.trajectory, settings_.switch_reach); !why.empty()) return why;
    pieces_.clear();
    current_ = 0;
    take(command, 0.0, runner_.offset());
    return {};
  }
  const Piece& last = pieces_.back();
  double leave = runner_.time();
  if (command.switch_at > 0) leave = std::max(leave, std::min(last.offset + command.switch_at, runner_.duration()));
  const bool waits = leave > runner_.time();
  if (waits && pieces_.size() > current_ + kMostWaiting) return std::to_string(kMostWaiting) + " trajectories wait already";
  const double before = runner_.time(), reach = leave < runner_.duration() ? settings_.switch_reach : settings_.start_tolerance;
  if (std::string why = runner_.switch_at(leave, command.trajectory, reach); !why.empty()) return why;
  // What was to come beyond is given up; and the path may have lost its beginning.
  const double shift = runner_.time() - before;
  pieces_.erase(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(current_));
  current_ = 0;
  while (pieces_.size() > 1 && pieces_.back().begin >= leave) pieces_.pop_back();
  for (Piece& p : pieces_) {
    p.begin += shift;
    p.offset += shift;
  }
  take(command, runner_.left_at(), runner_.offset());
  find_piece();
  return {};
}

Controller::Hand* Controller::find_hand(const std::string& group) {
  const auto found = std::find_if(hands_.begin(), hands_.end(), [&](const Hand& h) { return h.group == group; });
  if (found != hands_.end()) return &*found;
  return group.empty() && !hands_.empty() ? &hands_.front() : nullptr;
}

std::string Controller::accept(const HandCommand& command, Duration age, TimePoint) {
  if (command.id != 0 && command.id == accepted_hand_) return {};
  last_hand_ = command.id;
  std::string reason = why_not_now(command.robot, command.epoch, age);
  Hand* hand = find_hand(command.group);
  if (reason.empty()) reason = hand == nullptr ? "there is no hand \"" + command.group + "\"" : hand->executor.accept(command);
  if (hand != nullptr) hand->refused = !reason.empty();
  if (!reason.empty()) {
    refusal_ = "hand command " + std::to_string(command.id) + ": " + reason;
  } else {
    accepted_hand_ = command.id;
    if (command.action == HandAction::grasp && (command.payload > 0.0 || hand->payload == 0.0)) hand->grasped_payload = command.payload;
    refusal_.clear();
  }
  return reason;
}

}  // namespace handsel::trajectory_controller
