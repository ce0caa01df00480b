// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/motion_executor.hpp"

#include <algorithm>
#include <cmath>

#include "common/messages/names.hpp"
#include "common/model/human/human_body.hpp"
#include "components/manipulation_planner/handover/otp_choice.hpp"
#include "components/manipulation_planner/motion/tool_motion.hpp"
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kSameGoal = 1e-6;    // [rad]
constexpr double kMaxDuration = 600;  // a motion this long has been forgotten by everybody [s]
constexpr double kYieldRatios[] = {0.5, 1.0, 1.5};  // of the retreat distance, straight

double tilt_of(const Vector3& axis) { return std::acos(std::clamp(axis.z(), -1.0, 1.0)); }

/// Returns the sum of the max norms of the segments [rad].
double length_of(const std::vector<Vector>& waypoints) {
  double length = 0;
  for (std::size_t i = 1; i < waypoints.size(); ++i)
    length += (waypoints[i] - waypoints[i - 1]).cwiseAbs().maxCoeff();
  return length;
}

}  // namespace

const Group& group_of(const Parts& parts, const MotionSpec& motion) {
  return motion.is_of_platform ? parts.arm.robot().require_group(kPlatformGroup)
                               : parts.arm.group();
}

std::optional<TiltBound> tilt_bound(const Parts& parts, const MotionSpec& motion) {
  const ObjectModel* model =
      parts.held.is_holding() ? parts.now.model_of(parts.held.id()) : nullptr;
  if (model == nullptr || model->max_tilt <= 0 || motion.is_of_platform) return std::nullopt;
  const Vector3 axis = parts.held.attachment().T_tool_object.linear() * Vector3::UnitZ();
  const double now = tilt_of(parts.arm.T_world_tool().linear() * axis);
  if (now > model->max_tilt) return std::nullopt;
  return TiltBound{axis, std::max(model->max_tilt - parts.settings.tilt_margin,
                                  now + parts.settings.tilt_noise)};
}

PathRequest path_request(Parts& parts, const Vector& start, const MotionSpec& motion) {
  PathRequest request;
  parts.clients.path.open(request);
  request.group = group_of(parts, motion).name;
  request.start = start;
  request.goals = motion.goals;
  request.attachment = parts.held.attachment();
  request.allowed_contacts = motion.allowed;
  request.time_limit = parts.settings.planning_time;
  request.seed = parts.action.id + request.id.number;
  request.straight = motion.shape != MotionShape::free;
  if (const std::optional<TiltBound> bound = tilt_bound(parts, motion)) {
    request.upright = true;
    request.upright_axis = bound->axis_tool;
    request.max_tilt = bound->max_tilt;
  }
  return request;
}

TrajectoryRequest trajectory_request(Parts& parts,
                                     Client<TrajectoryRequest, TrajectoryReply>& client,
                                     const std::vector<Vector>& waypoints, const Vector& start,
                                     const MotionSpec& motion) {
  TrajectoryRequest request;
  client.open(request);
  request.group = group_of(parts, motion).name;
  request.nodes = waypoints;
  request.start = start;
  request.attachment = parts.held.attachment();
  request.allowed_contacts = motion.allowed;
  request.speed_scale = motion.speed;
  return request;
}

TrajectoryCommand trajectory_command(Parts& parts, const Trajectory& trajectory,
                                     const MotionSpec& motion) {
  TrajectoryCommand command = parts.link.stop_command();
  for (const int axis : group_of(parts, motion).axes)
    command.axes.push_back(static_cast<std::uint32_t>(axis));
  command.trajectory = trajectory;
  command.attachment = parts.held.attachment();
  command.allowed_contacts = motion.allowed;
  command.allowed_contacts.insert(command.allowed_contacts.end(), motion.tolerated.begin(),
                                  motion.tolerated.end());
  return command;
}

Routine<PlannedPath> plan_path(Parts& parts, const Vector& start, const MotionSpec& motion) {
  const PathRequest request = path_request(parts, start, motion);
  PlannedPath planned;
  const bool answered = co_await parts.clients.path.ask(request);
  if (!answered) {
    planned.outcome = Outcome::no_answer("path");
    co_return planned;
  }
  const PathReply& reply = *parts.clients.path.reply();
  planned.waypoints = reply.path;
  planned.start_touches = reply.start_touches;
  if (!reply.solved) planned.outcome = Outcome::failure(reply.reason);
  if (length_of(planned.waypoints) > motion.max_length)
    planned.outcome = Outcome::failure("only a long detour leads there");
  co_return planned;
}

/// Returns where attention expects the object that a motion follows, at most max_shift from where
/// it is seen, world [m]; nullopt: it expects nothing else.
static std::optional<Vector3> p_ahead_of(const Parts& parts, const MotionSpec& motion) {
  const SceneObject* object = parts.now.object(motion.object->object);
  if (object == nullptr) return std::nullopt;
  return parts.shift.wanted_around(object->T_world_object.translation(),
                                   parts.action.exchange_point, parts.now.time());
}

/// Replans the running motion until it ends by itself or must end.
static Routine<bool> watch_motion(Parts& parts, RunningMotion& running, MotionSpec& motion,
                                  TimePoint began) {
  const auto is_over = [&] {
    return parts.link.has_ended(running.command) || parts.monitor.must_end(motion, began);
  };
  const bool is_replanned = parts.settings.live_period > 0 && motion.shape == MotionShape::free;
  for (bool done = false; !done;) {
    const double period = is_replanned ? parts.replanner.period(parts.now.time()) : kMaxDuration;
    done = co_await parts.waiting.until(is_over, period);
    if (done || !is_replanned) break;
    if (motion.receiver) {
      const bool has_moved = co_await follow_receiver(parts, motion, running.waypoints.back());
      if (!has_moved) co_await follow_shift(parts, motion, running.waypoints.back());
    }
    const bool follows = motion.object && motion.object->grasp;
    const std::optional<Vector3> p_moved =
        follows ? parts.monitor.follow_object(motion, p_ahead_of(parts, motion)) : std::nullopt;
    co_await parts.replanner.check(running, motion);
    if (p_moved && (running.waypoints.back() - motion.goals.front()).norm() < kSameGoal) {
      motion.object->p_world = parts.action.exchange_point = *p_moved;
      parts.shift.note_change(*p_moved, parts.now.time());
    }
  }
  co_return parts.link.has_ended(running.command);
}

/// Executes the trajectory that was planned last.
static Routine<Outcome> run_planned(Parts& parts, const std::vector<Vector>& waypoints,
                                    MotionSpec& motion) {
  auto& timing = parts.clients.trajectory;
  for (const auto& corner : timing.reply()->corners) parts.refuse(corner.what, corner.reason);
  TrajectoryCommand command = trajectory_command(parts, timing.reply()->trajectory, motion);
  command.axes = timing.reply()->axes;
  Outcome sent = co_await parts.link.send(command);
  if (!sent.good) co_return sent;

  RunningMotion running{command.id, command.trajectory.duration(), waypoints,
                        timing.reply()->speeds};
  const TimePoint began = parts.now.time();
  parts.monitor.restart();
  const bool ended = co_await watch_motion(parts, running, motion, began);
  if (ended) {
    Outcome end = co_await parts.link.end_of(running.command);
    co_return end;
  }
  const bool is_area_cleared = parts.monitor.is_area_cleared(motion);
  const Outcome why = parts.monitor.why_ended(motion, began);
  co_await parts.link.stop();
  if (is_area_cleared) co_return Outcome{};
  co_return why;
}

Routine<Outcome> execute(Parts& parts, const std::vector<Vector>& waypoints, MotionSpec& motion) {
  auto& timing = parts.clients.trajectory;
  const TrajectoryRequest request =
      trajectory_request(parts, timing, waypoints, parts.arm.configuration(), motion);
  const bool answered = co_await timing.ask(request);
  if (!answered) co_return Outcome::no_answer("trajectory");
  if (!timing.reply()->solved) co_return Outcome::failure(timing.reply()->reason);
  Outcome run = co_await run_planned(parts, waypoints, motion);
  co_return run;
}

/// Plans and executes a straight motion of the tool; nullopt: there is none, for a reason that is
/// reported.
static Routine<std::optional<Outcome>> move_tool(Parts& parts, MotionSpec& motion) {
  const std::optional<TrajectoryRequest> request = tool_request(parts, motion);
  if (!request) co_return std::nullopt;
  auto& timing = parts.clients.trajectory;
  const bool answered = co_await timing.ask(*request);
  if (!answered) co_return Outcome::no_answer("trajectory");
  if (!timing.reply()->solved) {
    parts.refuse("straight motion of the tool", timing.reply()->reason);
    co_return std::nullopt;
  }
  const std::vector<Vector> ends{parts.arm.joints(), motion.goals.front()};
  Outcome run = co_await run_planned(parts, ends, motion);
  co_return run;
}

/// Retreats from what ended a motion or is touched at its start; the reason grows if that fails.
static Routine<bool> free_arm(Parts& parts, const std::string& touched, const MotionSpec& motion,
                              Outcome& last) {
  parts.refuse(text_of(motion.phase), last.reason);
  Outcome freed = co_await retreat_from(parts, touched, motion);
  if (!freed.good) last.reason += "; " + freed.reason;
  co_return freed.good;
}

Routine<Outcome> move(Parts& parts, const MotionSpec& asked) {
  Outcome last;
  MotionSpec motion = asked;
  for (std::uint32_t attempt = 0; attempt < parts.settings.motion_attempts; ++attempt) {
    parts.action.phase = motion.phase;
    const bool ready = co_await parts.link.await_permission();
    if (!ready) co_return parts.link.not_permitted();
    if (parts.held.is_taken_by(motion.yields_to))
      co_return parts.monitor.why_ended(motion, parts.now.time());
    const Vector start = parts.arm.configuration();
    std::optional<Outcome> by_tool;
    if (motion.shape == MotionShape::straight_tool) {
      by_tool = co_await move_tool(parts, motion);
      motion.shape = MotionShape::straight_axes;  // in further attempts
    }
    PlannedPath planned;
    if (!by_tool) planned = co_await plan_path(parts, start, motion);
    std::string in_the_way;
    if (planned.outcome.good) {
      last = by_tool ? *by_tool : Outcome{};
      if (!by_tool) last = co_await execute(parts, planned.waypoints, motion);
      if (last.good || last.is_final()) co_return last;
      const Person* person =
          last.end == MotionEnd::person_too_near ? parts.now.person("") : nullptr;
      if (person != nullptr) in_the_way = person->id;
    } else {
      last = planned.outcome;
      in_the_way = planned.start_touches;
      if (is_lost(parts.now, in_the_way)) {
        parts.refuse(text_of(motion.phase), last.reason);
        const auto is_gone = [&] { return !is_lost(parts.now, in_the_way); };
        co_await parts.waiting.until(is_gone, parts.settings.permission_timeout);
        continue;
      }
    }
    if (!in_the_way.empty() && !motion.is_of_platform) {
      const bool freed = co_await free_arm(parts, in_the_way, motion, last);
      if (freed) continue;
    }
    parts.refuse(text_of(motion.phase), last.reason);
    co_await parts.waiting.pause(parts.settings.attempt_pause);
  }
  co_return last;
}

std::vector<Vector3> retreat_directions_from(const Parts& parts, const std::string& touched) {
  const Pose T_tool = parts.arm.T_world_tool();
  Vector3 from = T_tool.translation() + T_tool.linear().col(2);
  if (const Person* person = parts.now.person(touched))
    from = person->joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  else if (const SceneObject* object = parts.now.object(touched))
    from = object->T_world_object.translation();
  return retreat_directions(T_tool, from, T_world_platform(parts.now).translation());
}

/// Returns goals of a retreat, those that lead away from people first, then in the order of the
/// search.
static std::vector<Vector> retreat_goals(const Parts& parts, const std::string& touched,
                                         const Vector& start) {
  const double distance = parts.settings.retreat_distance;
  const Pose& T_world_base = parts.now.T_world_base();
  const HumanState& people = parts.now.people();
  std::vector<Vector> goals = parts.retreat.steps_away(start, T_world_base, people,
                                                       parts.settings.max_retreat_ratio * distance);
  std::reverse(goals.begin(), goals.end());
  for (const double ratio : kYieldRatios) {
    for (const Vector3& direction : retreat_directions_from(parts, touched)) {
      Pose T = parts.arm.T_world_tool();
      T.translation() += ratio * distance * direction;
      if (const auto joints = parts.arm.reach(T)) goals.push_back(*joints);
    }
  }
  std::stable_partition(goals.begin(), goals.end(), [&](const Vector& goal) {
    return parts.retreat.leads_away(start, RobotModel::with(start, parts.arm.group(), goal),
                                    T_world_base, people);
  });
  return goals;
}

Routine<Outcome> retreat_from(Parts& parts, const std::string& touched, const MotionSpec& next) {
  MotionSpec off;
  off.phase = ActionPhase::retreat_from_person;
  off.shape = MotionShape::straight_axes;
  off.speed = parts.settings.approach_speed;
  off.allowed = next.allowed;
  off.allowed.push_back(touched);
  const Vector start = parts.arm.configuration();
  const std::vector<Vector> goals = retreat_goals(parts, touched, start);
  for (const Vector& goal : goals) {
    const Vector clear = RobotModel::with(start, parts.arm.group(), goal);
    off.goals = {goal};
    PlannedPath first = co_await plan_path(parts, start, off);
    if (!first.outcome.good) continue;
    PlannedPath then = co_await plan_path(parts, clear, next);
    if (!then.outcome.good) continue;
    parts.action.phase = off.phase;
    Outcome outcome = co_await execute(parts, first.waypoints, off);
    co_return outcome;
  }
  co_return Outcome::failure("no straight path leads off " + touched);
}

}  // namespace handsel::manipulation_planner
