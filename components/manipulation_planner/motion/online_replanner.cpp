// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/online_replanner.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/trajectory/path/broken_line.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kSameTime = 1e-6;  // [s]
constexpr double kAtRest = 1e-9;    // [rad/s, m/s]

/// Returns whether one of the last `segments` segments must be slower than it was timed, to less
/// than `ratio` of that. Speeds as in TrajectoryReply.
bool is_slower_ahead(const Vector& before, const Vector& now, std::size_t segments, double ratio) {
  const auto from_end = [](const Vector& speeds, std::size_t k) {
    const auto index = static_cast<Eigen::Index>(k);
    return index < speeds.size() ? speeds[speeds.size() - 1 - index] : 1.0;
  };
  for (std::size_t k = 0; k < segments; ++k)
    if (from_end(now, k) < ratio * from_end(before, k)) return true;
  return false;
}

}  // namespace

void OnlineReplanner::advise(double period, double cost_gain, TimePoint now) {
  period_.advise(period, now);
  cost_gain_ = cost_gain;
}

bool OnlineReplanner::is_over(const RunningMotion& running) const {
  const ExecutionStatus& status = *parts_.now.execution();
  return status.trajectory != running.command || status.motion != MotionState::running;
}

SwitchPlanner OnlineReplanner::switch_planner(const MotionSpec& motion) const {
  const auto& settings = parts_.settings;
  return {parts_.arm.shared_robot(),
          group_of(parts_, motion),
          {.max_slower = settings.live_slower,
           .min_saved = settings.live_gain,
           .reserve = settings.switch_reserve,
           .step = settings.switch_step,
           .rest_step = settings.switch_rest_step,
           .margin = settings.switch_margin}};
}

PlanningSnapshot OnlineReplanner::snapshot(const MotionSpec& motion,
                                           const SwitchPoint& point) const {
  Snapshot& now = parts_.now;
  const Vector q =
      RobotModel::with(parts_.arm.configuration(), group_of(parts_, motion), point.from.position);
  const double gain = period_.is_advised(now.time()) ? cost_gain_ : 1.0;
  return {now.scene(),
          now.people(),
          now.layers(),
          parts_.held.attachment(),
          motion.allowed,
          q,
          gain,
          tilt_bound(parts_, motion),
          parts_.arm.palm()};
}

Outcome OnlineReplanner::find_switch_point(const RunningMotion& running, const MotionSpec& motion,
                                           SwitchPoint& point) const {
  const ActiveTrajectory& active = parts_.now.active();
  // What the arm does within that time: less while it is slowed.
  const double replan_time = parts_.settings.replan_time *
                             std::clamp(active.speed_factor, parts_.settings.live_min_factor, 1.0);
  if (active.trajectory != running.command ||
      active.rest.size() != static_cast<int>(group_of(parts_, motion).axes.size()))
    return Outcome::failure("the controller tells of another motion");
  const double duration = active.rest.duration();
  point.offset = duration - running.duration;
  point.at_rest = is_at_rest(motion);
  point.time = active.time + (point.at_rest ? 0.0 : replan_time);
  if (!point.at_rest && point.time <= point.offset) return Outcome::failure("it has not begun yet");
  if (point.time + replan_time > duration) return Outcome::failure("it is nearly there");
  point.from = active.rest.at(point.time);
  point.rest = duration - point.time;
  return {};
}

Routine<Outcome> OnlineReplanner::check(RunningMotion& running, const MotionSpec& motion) {
  SwitchPoint point;
  Outcome found = find_switch_point(running, motion, point);
  if (!found.good) co_return found;
  const Vector start =
      RobotModel::with(parts_.arm.configuration(), group_of(parts_, motion), point.from.position);
  auto& path = parts_.clients.path;
  PathRequest request = path_request(parts_, start, motion);
  request.running = running.waypoints;
  request.time_limit = parts_.settings.live_time;
  ++counts_.checks;
  path.send(request);
  const auto has_come = [this, &path, &running] {
    return path.reply().has_value() || is_over(running);
  };
  const bool has_path = co_await parts_.waiting.until(has_come, parts_.settings.replan_time);
  if (!has_path || is_over(running)) co_return Outcome::failure("no path came in time");
  if (!path.reply()->solved) {
    ++counts_.refused;
    co_return Outcome::failure(path.reply()->reason);
  }
  Outcome planned = co_await plan(running, motion, point, start);
  co_return planned;
}

/// Times the path that has come, and the running one as it would be now, and uses the better one.
Routine<Outcome> OnlineReplanner::plan(RunningMotion& running, const MotionSpec& motion,
                                       const SwitchPoint& point, const Vector& start) {
  const auto& settings = parts_.settings;
  auto& timing = parts_.clients.trajectory;
  auto& comparison = parts_.clients.comparison;
  const PathOutcome outcome = parts_.clients.path.reply()->outcome;
  const std::vector<Vector> waypoints = parts_.clients.path.reply()->path;
  const bool is_unchanged = outcome == PathOutcome::kept,
             is_only_cheaper = outcome == PathOutcome::improved;
  const std::vector<Vector> as_before =
      remainder(running.waypoints, point.from.position, settings.live_reach);
  const bool is_compared =
      is_only_cheaper || (is_unchanged && settings.live_pace > 0 && !as_before.empty());
  if (is_compared)
    comparison.send(trajectory_request(parts_, comparison, as_before, start, motion));
  if (!is_unchanged) timing.send(trajectory_request(parts_, timing, waypoints, start, motion));
  const auto have_come = [&] {
    return ((is_unchanged || timing.reply()) && (!is_compared || comparison.reply())) ||
           is_over(running);
  };
  const bool is_timed = co_await parts_.waiting.until(have_come, settings.replan_time);
  if (!is_timed || is_over(running)) co_return Outcome::failure("no trajectory came in time");
  if (is_unchanged) {
    ++counts_.unchanged;
  } else {
    if (!timing.reply()->solved) {
      ++counts_.refused;
      co_return Outcome::failure(timing.reply()->reason);
    }
    auto candidate = std::make_shared<SwitchCandidate>();
    candidate->onto = timing.reply()->trajectory;
    candidate->max_reach = settings.live_reach;
    if (is_only_cheaper && comparison.reply()->solved)
      candidate->along = comparison.reply()->trajectory;
    const RunningMotion next{0, 0, waypoints, timing.reply()->speeds};
    Outcome switched = co_await switch_to_candidate(running, motion, point, candidate, next);
    if (switched.good) ++counts_.switched;
    if (switched.good || candidate->is_worth) co_return switched;
    ++counts_.slower;
    if (!is_only_cheaper || is_over(running)) co_return switched;
  }
  if (!is_compared || !comparison.reply()->solved || settings.live_pace <= 0) co_return Outcome{};
  Outcome retimed = co_await retime(running, motion, point, as_before);
  if (retimed.good) ++counts_.retimed;
  co_return Outcome{};
}

/// Runs the same path slower where a segment ahead must be slower, faster where all the rest then
/// is.
Routine<Outcome> OnlineReplanner::retime(RunningMotion& running, const MotionSpec& motion,
                                         const SwitchPoint& point,
                                         const std::vector<Vector>& waypoints) {
  const TrajectoryReply reply = *parts_.clients.comparison.reply();
  auto candidate = std::make_shared<SwitchCandidate>();
  candidate->onto = reply.trajectory;
  candidate->speed = reply.speeds.size() > 0 ? reply.speeds[0] : 1.0;
  const SwitchPlanner planner = switch_planner(motion);
  Switched along;
  along.trajectory = reply.trajectory;
  for (double reach = parts_.settings.live_same_path;
       !point.at_rest && reach <= parts_.settings.live_reach;
       reach += parts_.settings.live_same_path_step) {
    candidate->max_reach = reach;
    along = planner.join(point.from, reply.trajectory, *candidate);
    if (along.ok() && !turns_back(along, reply.trajectory)) break;
  }
  if (!along.ok() || turns_back(along, reply.trajectory))
    co_return Outcome::failure("the arm is too fast to go over");
  const double ratio = 1 - parts_.settings.live_pace;
  if (!is_slower_ahead(running.speeds, reply.speeds, waypoints.size() - 1, ratio)) {
    const bool is_faster =
        is_slower_ahead(reply.speeds, running.speeds, waypoints.size() - 1, ratio);
    if (!is_faster || along.trajectory.duration() > ratio * point.rest)
      co_return Outcome::failure("it would go as before");
  }
  const RunningMotion next{0, 0, waypoints, reply.speeds};
  Outcome switched = co_await switch_to_candidate(running, motion, point, candidate, next);
  co_return switched;
}

bool OnlineReplanner::is_at_rest(const MotionSpec& motion) const {
  return parts_.now.set_point().size() == parts_.arm.robot().dof() &&
         parts_.now.active().velocity(group_of(parts_, motion).axes).norm() < kAtRest;
}

bool OnlineReplanner::is_too_late(const MotionSpec& motion, const SwitchPoint& point) const {
  const double time = parts_.now.active().time;
  return point.at_rest ? !is_at_rest(motion) || time > point.time + kSameTime
                       : time + parts_.settings.live_lead > point.time;
}

/// Switches to the candidate if it is free of collision, worth the switch and in time. `next`: its
/// waypoints and speeds.
Routine<Outcome> OnlineReplanner::switch_to_candidate(
    RunningMotion& running, const MotionSpec& motion, const SwitchPoint& point,
    const std::shared_ptr<SwitchCandidate>& candidate, const RunningMotion& next) {
  const std::function<void()> job =
      [candidate, point, cost = cost_, planner = switch_planner(motion),
       world = parts_.worker.world(parts_.arm.robot(), parts_.now.objects()),
       now = snapshot(motion, point)] { planner.evaluate(*candidate, *world, *cost, now, point); };
  Outcome worked = co_await parts_.worker.run(job);
  if (!worked.good) co_return worked;
  if (is_over(running)) co_return Outcome::failure("the motion has ended");
  if (!candidate->onto) {
    ++counts_.refused;
    co_return Outcome::failure("no free motion leads over to the new path");
  }
  if (!candidate->is_worth)
    co_return Outcome::failure("the new path takes longer than it is worth");
  if (is_too_late(motion, point)) {
    ++counts_.refused;
    co_return Outcome::failure("the new path came too late");
  }
  TrajectoryCommand command = trajectory_command(parts_, *candidate->onto, motion);
  command.switch_at = point.at_rest ? 0.0 : point.time - point.offset;
  Outcome sent = co_await parts_.link.send(command);
  if (!sent.good) co_return sent;
  if (parts_.now.execution()->motion == MotionState::refused) {
    ++counts_.refused;
    const Outcome why = Outcome::failure("the new path was refused: " + parts_.link.reason());
    const auto is_back = [this, &running] {
      return parts_.now.execution()->trajectory == running.command;
    };
    co_await parts_.waiting.until(is_back, parts_.settings.switch_back_timeout);
    co_return why;
  }
  running = next;
  running.command = command.id;
  running.duration = command.trajectory.duration();
  co_return Outcome{};
}

}  // namespace handsel::manipulation_planner
