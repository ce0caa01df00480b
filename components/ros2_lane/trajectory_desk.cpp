#include "components/ros2_lane/trajectory_desk.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace handsel::ros2_lane {
namespace {

constexpr double kAtRest = 1e-3;   // [rad/s]
constexpr double kSame = 1e-6;     // [rad] two points are one
constexpr double kSilent = 0.3;    // [s] the controller was not heard
constexpr double kRetry = 0.5;     // [s]
constexpr double kPatience = 5.0;  // [s] for an answer
constexpr double kSlower = 1.05;   // asked for this much longer: it is timed once more
constexpr double kSlowest = 0.02;  // of the comfort velocities
constexpr std::size_t kMostStates = 4096;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

}  // namespace

TrajectoryDesk::TrajectoryDesk(const settings::Ros2LaneSettings& settings, std::shared_ptr<const RobotModel> robot, std::uint64_t client)
    : settings_(settings), robot_(std::move(robot)), arm_(robot_->require_group("arm")), client_(client), commands_(client) {}

void TrajectoryDesk::on(const ActiveTrajectory& active, TimePoint arrival) {
  active_ = active;
  active_at_ = arrival;
}

void TrajectoryDesk::on(const StateVerdict& verdict) {
  if (verdict.id == query_.id) verdict_ = verdict;
}

void TrajectoryDesk::on(const TrajectoryReply& reply) {
  if (reply.id == request_.id) reply_ = reply;
}

std::string TrajectoryDesk::why_not_now(TimePoint now) const {
  if (!active_ || !execution_ || to_seconds(now - active_at_) > kSilent) return "the trajectory controller is not heard";
  if (action_ && action_->state == ActionState::running) return "a task runs; cancel it first";
  for (const int axis : arm_.axes)
    if (std::abs(active_->velocity[axis]) > kAtRest) return "the arm is in motion";
  return {};
}

std::string TrajectoryDesk::prepare(const ros2::JointTrajectory& wanted, TimePoint now) {
  if (std::string why = why_not_now(now); !why.empty()) return why;
  std::vector<std::size_t> place;  // in the arm's group, of each joint named
  for (const std::string& name : wanted.joint_names) {
    const auto at = std::find_if(arm_.axes.begin(), arm_.axes.end(),
                                 [&](int axis) { return robot_->axes()[static_cast<std::size_t>(axis)].name == name; });
    if (at == arm_.axes.end()) return "joint " + name + " is no joint of the arm of " + robot_->name();
    const auto index = static_cast<std::size_t>(at - arm_.axes.begin());
    if (std::find(place.begin(), place.end(), index) != place.end()) return "joint " + name + " is named twice";
    place.push_back(index);
  }
  if (place.empty()) return "it names no joints";

  const Vector here = RobotModel::part(active_->position, arm_);
  request_ = {};
  request_.group = arm_.name;
  request_.start = active_->position;
  request_.attachment = active_->attachment;
  if (!request_.attachment.object.empty()) request_.allowed_contacts = {request_.attachment.object};
  request_.nodes = {here};
  for (std::size_t p = 0; p < wanted.points.size(); ++p) {
    Vector node = here;
    for (std::size_t j = 0; j < place.size(); ++j) {
      const Axis& axis = robot_->axes()[static_cast<std::size_t>(arm_.axes[place[j]])];
      const double value = wanted.points[p].positions[static_cast<Eigen::Index>(j)];
      if (value < axis.lower || value > axis.upper)
        return "point " + std::to_string(p) + " has " + axis.name + " at " + number(value) + ", outside " + number(axis.lower) + " to " +
               number(axis.upper);
      node[static_cast<Eigen::Index>(place[j])] = value;
    }
    const double off = (node - here).cwiseAbs().maxCoeff();
    if (p == 0 && wanted.points[0].time_from_start == 0) {
      if (off > settings_.start_tolerance) return "its first point, at time 0, is " + number(off) + " rad from where the arm is";
      continue;
    }
    if ((node - request_.nodes.back()).cwiseAbs().maxCoeff() > kSame) request_.nodes.push_back(std::move(node));
  }
  if (request_.nodes.size() < 2) return "it ends where the arm is";
  wanted_ = wanted.points.back().time_from_start;

  query_ = {};
  query_.attachment = request_.attachment;
  query_.allowed_contacts = request_.allowed_contacts;
  for (std::size_t n = 1; n < request_.nodes.size(); ++n) {
    const Vector step = request_.nodes[n] - request_.nodes[n - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(step.cwiseAbs().maxCoeff() / settings_.check_step)));
    for (int i = 1; i <= parts; ++i)
      query_.states.push_back(
          RobotModel::with(request_.start, arm_, Vector(request_.nodes[n - 1] + static_cast<double>(i) / parts * step)));
    if (query_.states.size() > kMostStates) return "it is too long to be checked at once";
  }
  return {};
}

void TrajectoryDesk::on(const ros2::JointTrajectory& wanted, TimePoint now, TrajectoryOutbox& out) {
  if (wanted.points.empty()) return stop(out);
  if (phase_ != Phase::idle) {
    out.results.push_back("refused: another one has not ended");
    return;
  }
  if (const std::string why = prepare(wanted, now); !why.empty()) return refuse(why, out);
  verdict_.reset();
  reply_.reset();
  slowed_ = false;
  query_.id = {client_, ++number_};
  phase_ = Phase::judging;
  begun_ = now;
  fresh_ = true;
}

void TrajectoryDesk::stop(TrajectoryOutbox& out) {
  if (phase_ != Phase::running && phase_ != Phase::handing_over) {
    if (phase_ != Phase::idle) refuse("stopped before it began", out);
    return;
  }
  TrajectoryCommand halt;
  halt.id = ++commands_;
  halt.epoch = execution_->epoch;
  halt.robot = robot_->name();
  command_ = halt;
  phase_ = Phase::handing_over;
  fresh_ = true;
}

void TrajectoryDesk::refuse(const std::string& why, TrajectoryOutbox& out) {
  out.results.push_back("refused: " + why);
  out.command_done = true;
  phase_ = Phase::idle;
}

void TrajectoryDesk::step(TimePoint now, TrajectoryOutbox& out) {
  if (phase_ == Phase::idle) return;
  if (fresh_) begun_ = now;
  const bool due = fresh_ || to_seconds(now - asked_) >= kRetry;
  fresh_ = false;
  if (phase_ != Phase::running && to_seconds(now - begun_) > kPatience) {
    return refuse(std::string(phase_ == Phase::judging  ? "the collision checker"
                              : phase_ == Phase::timing ? "the trajectory planner"
                                                        : "the trajectory controller") +
                      " does not answer",
                  out);
  }
  switch (phase_) {
    case Phase::judging:
      if (verdict_) return ask(out);
      if (due) out.query = query_;
      break;
    case Phase::timing:
      if (reply_) return hand_over(out);
      if (due) out.request = request_;
      break;
    case Phase::handing_over:
      if (execution_->trajectory == command_.id) {
        out.command_done = true;
        phase_ = Phase::running;
        return follow(out);
      }
      if (due) out.command = command_;
      break;
    default:
      return follow(out);
  }
  if (due) asked_ = now;
}

void TrajectoryDesk::ask(TrajectoryOutbox& out) {
  const auto hit = std::find(verdict_->free.begin(), verdict_->free.end(), 0);
  if (hit != verdict_->free.end() || verdict_->free.size() != query_.states.size())
    return refuse("the way is not free: " + verdict_->reason, out);
  request_.id = {client_, ++number_};
  phase_ = Phase::timing;
  fresh_ = true;
}

void TrajectoryDesk::hand_over(TrajectoryOutbox& out) {
  if (!reply_->solved) return refuse(reply_->reason, out);
  const double duration = reply_->trajectory.duration();
  if (!slowed_ && wanted_ > kSlower * duration) {
    slowed_ = true;
    request_.speed_scale = std::clamp(duration / wanted_, kSlowest, 1.0);
    request_.id = {client_, ++number_};
    reply_.reset();
    fresh_ = true;
    return;
  }
  command_ = {};
  command_.id = ++commands_;
  command_.epoch = execution_->epoch;
  command_.robot = robot_->name();
  for (const int axis : arm_.axes) command_.axes.push_back(static_cast<std::uint32_t>(axis));
  command_.trajectory = reply_->trajectory;
  command_.attachment = request_.attachment;
  command_.allowed_contacts = request_.allowed_contacts;
  phase_ = Phase::handing_over;
  fresh_ = true;
}

void TrajectoryDesk::follow(TrajectoryOutbox& out) {
  const bool ours = execution_->trajectory == command_.id;
  if (ours && execution_->motion == MotionState::running) return;
  phase_ = Phase::idle;
  if (!ours) {
    out.results.push_back("ended: another motion took its place");
  } else if (execution_->motion == MotionState::refused) {
    out.results.push_back("refused: " + execution_->reason);
  } else if (execution_->motion == MotionState::finished) {
    out.results.push_back("done");
  } else {
    out.results.push_back("stopped" + (execution_->reason.empty() ? std::string() : ": " + execution_->reason));
  }
}

}  // namespace handsel::ros2_lane
