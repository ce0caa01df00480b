// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/trajectory_executor.hpp"

#include <algorithm>

namespace handsel::ros2_lane {

TrajectoryExecutor::TrajectoryExecutor(const settings::Ros2LaneSettings& settings,
                                       std::shared_ptr<const RobotModel> robot,
                                       std::uint64_t client)
    : settings_(settings),
      robot_(std::move(robot)),
      arm_(robot_->require_group("arm")),
      client_(client),
      commands_(client) {}

void TrajectoryExecutor::on(const StateVerdict& verdict) {
  if (verdict.id == query_.id) verdict_ = verdict;
}

void TrajectoryExecutor::on(const TrajectoryReply& reply) {
  if (reply.id == request_.id) reply_ = reply;
}

std::string TrajectoryExecutor::prepare(const ros2::JointTrajectory& wanted, TimePoint now) {
  if (std::string why = activity_.why_not_ready(arm_, now, settings_.report_age); !why.empty())
    return why;
  MotionRequest motion;
  if (std::string why = make_motion_request(wanted, *robot_, activity_.active(), settings_, motion);
      !why.empty())
    return why;
  query_ = std::move(motion.query);
  request_ = std::move(motion.request);
  min_duration_ = motion.min_duration;
  return {};
}

void TrajectoryExecutor::on(const ros2::JointTrajectory& wanted, TimePoint now,
                            TrajectoryOutbox& out) {
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
  phase_ = Phase::checking;
  begun_ = now;
  fresh_ = true;
}

void TrajectoryExecutor::stop(TrajectoryOutbox& out) {
  if (phase_ != Phase::running && phase_ != Phase::handing_over) {
    if (phase_ != Phase::idle) refuse("stopped before it began", out);
    return;
  }
  TrajectoryCommand halt;
  halt.id = ++commands_;
  halt.epoch = activity_.execution().epoch;
  halt.robot = robot_->name();
  command_ = halt;
  phase_ = Phase::handing_over;
  fresh_ = true;
}

void TrajectoryExecutor::refuse(const std::string& why, TrajectoryOutbox& out) {
  out.results.push_back("refused: " + why);
  out.command_done = true;
  phase_ = Phase::idle;
}

void TrajectoryExecutor::step(TimePoint now, TrajectoryOutbox& out) {
  if (phase_ == Phase::idle) return;
  if (fresh_) begun_ = now;
  const bool due = fresh_ || to_seconds(now - asked_) >= settings_.retry_period;
  fresh_ = false;
  if (phase_ != Phase::running && to_seconds(now - begun_) > settings_.answer_timeout) {
    return refuse(std::string(phase_ == Phase::checking ? "the collision checker"
                              : phase_ == Phase::timing ? "the trajectory planner"
                                                        : "the trajectory controller") +
                      " does not answer",
                  out);
  }
  switch (phase_) {
    case Phase::checking:
      if (verdict_) return ask(out);
      if (due) out.query = query_;
      break;
    case Phase::timing:
      if (reply_) return hand_over(out);
      if (due) out.request = request_;
      break;
    case Phase::handing_over:
      if (activity_.execution().trajectory == command_.id) {
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

void TrajectoryExecutor::ask(TrajectoryOutbox& out) {
  const auto hit = std::find(verdict_->free.begin(), verdict_->free.end(), 0);
  if (hit != verdict_->free.end() || verdict_->free.size() != query_.states.size())
    return refuse("the path is not free: " + verdict_->reason, out);
  request_.id = {client_, ++number_};
  phase_ = Phase::timing;
  fresh_ = true;
}

void TrajectoryExecutor::hand_over(TrajectoryOutbox& out) {
  if (!reply_->solved) return refuse(reply_->reason, out);
  const double duration = reply_->trajectory.duration();
  if (!slowed_ && min_duration_ > settings_.max_duration_ratio * duration) {
    slowed_ = true;
    request_.speed_scale = std::clamp(duration / min_duration_, settings_.min_speed_scale, 1.0);
    request_.id = {client_, ++number_};
    reply_.reset();
    fresh_ = true;
    return;
  }
  command_ = {};
  command_.id = ++commands_;
  command_.epoch = activity_.execution().epoch;
  command_.robot = robot_->name();
  for (const int axis : arm_.axes) command_.axes.push_back(static_cast<std::uint32_t>(axis));
  command_.trajectory = reply_->trajectory;
  command_.attachment = request_.attachment;
  command_.allowed_contacts = request_.allowed_contacts;
  phase_ = Phase::handing_over;
  fresh_ = true;
}

void TrajectoryExecutor::follow(TrajectoryOutbox& out) {
  const bool is_own = activity_.execution().trajectory == command_.id;
  if (is_own && activity_.execution().motion == MotionState::running) return;
  phase_ = Phase::idle;
  if (!is_own) {
    out.results.push_back("ended: another motion took its place");
  } else if (activity_.execution().motion == MotionState::refused) {
    out.results.push_back("refused: " + activity_.execution().reason);
  } else if (activity_.execution().motion == MotionState::finished) {
    out.results.push_back("done");
  } else {
    out.results.push_back("stopped" + (activity_.execution().reason.empty()
                                           ? std::string()
                                           : ": " + activity_.execution().reason));
  }
}

}  // namespace handsel::ros2_lane
