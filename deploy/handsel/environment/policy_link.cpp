// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/environment/policy_link.hpp"

#include <utility>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "deploy/handsel/cli/json_lines.hpp"

namespace handsel::environment {
namespace {

constexpr double kAnswerTimeout = 20.0;  // virtual time without a reply [s]
constexpr std::uint64_t kClient = 1;     // of the requests; no other component sends any
constexpr Duration kStatusPeriod = std::chrono::milliseconds(100);

std::vector<std::uint32_t> axes_of(const Group& group) {
  return {group.axes.begin(), group.axes.end()};
}

}  // namespace

PolicyLink::PolicyLink(LocalNetwork& network, const View& view,
                       std::shared_ptr<const RobotModel> robot, std::uint64_t seed)
    : network_(network), view_(view), robot_(std::move(robot)), seed_(seed) {
  Bus& bus = network.add("manipulation_planner");
  grasp_out_ = bus.advertise<GraspRequest>();
  path_out_ = bus.advertise<PathRequest>();
  timing_out_ = bus.advertise<TrajectoryRequest>();
  trajectory_out_ = bus.advertise<TrajectoryCommand>();
  hand_out_ = bus.advertise<HandCommand>();
  status_out_ = bus.advertise<ActionStatus>();
  bus.subscribe<GraspReply>([this](const GraspReply& m, const Receipt&) {
    if (m.id == RequestId{kClient, requests_}) grasp_reply_ = m;
  });
  bus.subscribe<PathReply>([this](const PathReply& m, const Receipt&) {
    if (m.id == RequestId{kClient, requests_}) path_reply_ = m;
  });
  bus.subscribe<TrajectoryReply>([this](const TrajectoryReply& m, const Receipt&) {
    if (m.id == RequestId{kClient, requests_}) timing_reply_ = m;
  });
  status_.kind = ActionKind::pick;
  bus.every(kStatusPeriod, [this](TimePoint) { publish_status(); });
}

void PolicyLink::publish_status() { status_out_->publish(status_); }

template <class Reply>
std::optional<Reply> PolicyLink::await(std::optional<Reply>& slot, double timeout) {
  network_.run_until([&] { return slot.has_value(); }, network_.now() + from_seconds(timeout));
  return std::exchange(slot, std::nullopt);
}

const Group& PolicyLink::group_of(const std::string& name) const {
  const Group* group = robot_->group(name);
  if (group != nullptr) return *group;
  std::string names;
  for (const Group& other : robot_->groups()) names += (names.empty() ? "" : ", ") + other.name;
  throw command::LineError(robot_->name() + " has no group \"" + name + "\"; it has: " + names);
}

GraspReply PolicyLink::grasps(const std::string& object, const std::string& for_human,
                              const std::string& group, std::uint32_t max_grasps) {
  GraspRequest request;
  request.id = {kClient, ++requests_};
  request.object = view_.object(object).id;
  request.start = view_.active().position;
  request.for_human = for_human;
  request.max_grasps = max_grasps;
  request.seed = seed_;
  request.group = group_of(group).name;
  grasp_out_->publish(request);
  std::optional<GraspReply> reply = await(grasp_reply_, kAnswerTimeout);
  if (reply) return std::move(*reply);
  GraspReply none;
  none.reason = "the grasp planner has not answered";
  return none;
}

TrajectoryCommand PolicyLink::command_head(const std::vector<std::string>& allowed) {
  TrajectoryCommand command;
  command.robot = robot_->name();
  command.attachment = attachment_;
  command.allowed_contacts = allowed;
  return command;
}

MotionPlan PolicyLink::plan(const MotionQuery& query) {
  const Group& group = group_of(query.group);
  PathRequest request;
  request.id = {kClient, ++requests_};
  request.group = group.name;
  request.start = view_.active().position;
  if (const Group* fingers = robot_->group("hand"); fingers != nullptr && query.hand.size() > 0)
    request.start = RobotModel::with(request.start, *fingers, query.hand);
  if (query.from.size() > 0) request.start = RobotModel::with(request.start, group, query.from);
  request.goals = query.goals;
  request.attachment = attachment_;
  request.allowed_contacts = query.allowed;
  request.time_limit = query.time_limit;
  request.seed = seed_ + requests_;
  request.straight = query.straight;
  path_out_->publish(request);
  const std::optional<PathReply> path = await(path_reply_, kAnswerTimeout);
  MotionPlan out;
  if (!path || !path->solved) {
    out.reason = path ? path->reason : "the path planner has not answered";
    return out;
  }
  out.path = path->path;
  TrajectoryRequest timing;
  timing.id = {kClient, ++requests_};
  timing.group = group.name;
  timing.nodes = path->path;
  timing.start = request.start;
  timing.attachment = attachment_;
  timing.allowed_contacts = query.allowed;
  timing.speed_scale = query.speed;
  timing_out_->publish(timing);
  const std::optional<TrajectoryReply> timed = await(timing_reply_, kAnswerTimeout);
  if (!timed || !timed->solved) {
    out.reason = timed ? timed->reason : "the trajectory planner has not answered";
    return out;
  }
  out.command = command_head(query.allowed);
  out.command.axes = timed->axes.empty() ? axes_of(group) : timed->axes;
  out.command.trajectory = timed->trajectory;
  return out;
}

MotionPlan PolicyLink::direct(const std::string& name, const Vector& target, double speed) const {
  const Group& group = group_of(name);
  KinematicLimits limits;
  const auto part = [&](const Vector& all) { return RobotModel::part(all, group); };
  limits.velocity = speed * part(robot_->comfort_limits().velocity);
  limits.acceleration = part(robot_->comfort_limits().acceleration);
  limits.jerk = part(robot_->comfort_limits().jerk);
  const Vector start = part(view_.active().position);
  const Solution solution = solve(rest_state(start), rest_state(target), limits);
  MotionPlan out;
  out.reason = solution.reason;
  out.path = {start, target};
  out.command.robot = robot_->name();
  out.command.attachment = attachment_;
  out.command.axes = axes_of(group);
  out.command.trajectory = solution.trajectory;
  return out;
}

void PolicyLink::run(MotionPlan plan) {
  plan.command.id = ++commands_;
  plan.command.epoch = view_.execution().epoch;
  trajectory_out_->publish(plan.command);
}

void PolicyLink::stop() {
  TrajectoryCommand command = command_head({});
  command.id = ++commands_;
  command.epoch = view_.execution().epoch;
  trajectory_out_->publish(command);
}

void PolicyLink::hand(HandCommand command) {
  command.id = ++commands_;
  command.epoch = view_.execution().epoch;
  command.robot = robot_->name();
  hand_out_->publish(command);
}

void PolicyLink::hold(const std::string& object) {
  attachment_ = {};
  status_.holding = !object.empty();
  status_.object = object;
  if (object.empty()) return;
  attachment_.object = object;
  const ActiveTrajectory& active = view_.active();
  const Pose T_world_tool =
      active.T_world_base * robot_->link_pose(active.position, robot_->tool_link());
  attachment_.T_tool_object = T_world_tool.inverse() * view_.object(object).T_world_object;
}

void PolicyLink::engage(const std::string& person, bool giving) {
  const bool engaged = !person.empty();
  if (engaged != status_.exchange_engaged) ++status_.id;
  status_.state = engaged ? ActionState::running : ActionState::idle;
  status_.kind = !engaged ? ActionKind::pick : giving ? ActionKind::give : ActionKind::receive;
  status_.phase = !engaged ? ActionPhase::none
                  : giving ? ActionPhase::offer
                           : ActionPhase::watching_for_offer;
  status_.human = person;
  status_.exchange_engaged = engaged;
  status_.task = engaged ? 1 : 0;
  if (engaged && robot_->tool_link() >= 0) {
    const ActiveTrajectory& active = view_.active();
    status_.exchange_point =
        (active.T_world_base * robot_->link_pose(active.position, robot_->tool_link()))
            .translation();
  }
  publish_status();
}

}  // namespace handsel::environment
