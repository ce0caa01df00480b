// SPDX-License-Identifier: Apache-2.0
// The manipulation planner with emulated planners and an emulated controller.
#pragma once

#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "common/messages/names.hpp"
#include "common/model/human/human_body.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner::rig {

inline settings::ManipulationPlannerSettings settings() {
  return settings::read_manipulation_planner_settings(
      resource("config/manipulation_planner.txtpb"));
}

// Emulates planners and controller: by default every request is answered at once and every
// trajectory reaches its end.
class Rig {
 public:
  explicit Rig(const std::string& description = "jido",
               const settings::ManipulationPlannerSettings& chosen = settings())
      : robot(std::make_shared<RobotModel>(RobotModel::load(robot_description(description)))),
        mug(ObjectModel::load(object_description("mug"))),
        planner(
            chosen, robot,
            [this](const std::string& name) { return name == "mug" ? &mug : nullptr; }, 1000) {
    q = robot->rest_configuration();
    scene.robot_known = true;
    scene.T_world_base = Pose::Identity();
    scene.boxes.push_back({"table", make_pose({0.7, -0.6, 0.35}), {0.6, 0.6, 0.7}, true});
    scene.objects.push_back(
        {"mug", "mug", make_pose({0.7, -0.6, 0.75}), Holder::surface, "table", 0});
    Person anna;
    anna.id = "anna";
    anna.joints = standing_body({1.45, 0, 0}, 3.14159, 1.75);
    people.people.push_back(anna);
    execution.mode = Mode::normal;
    execution.epoch = 1;
  }

  void start(ActionKind kind) {
    ActionGoal goal;
    goal.id = ++actions;
    goal.kind = kind;
    goal.object = "mug";
    goal.human = "anna";
    goal.surface = "table";
    planner.on(goal);
  }

  void start(const ActionGoal& goal) {
    ActionGoal numbered = goal;
    numbered.id = ++actions;
    planner.on(numbered);
  }

  void run(double duration) {
    for (double t = 0; t < duration && (t < 0.1 || planner.status().state == ActionState::running);
         t += 0.02)
      cycle();
  }

  void run_until(const std::string& phase) {
    for (int i = 0; i < 1500 && phase_text(planner.status()) != phase; ++i) cycle();
  }

  void cycle() {
    now += from_seconds(0.02);
    scene.robot_position = q;
    for (auto& object : scene.objects)
      if (object.holder == Holder::robot) object.T_world_object = tool() * T_tool_mug;
    planner.on(scene);
    planner.on(people);
    planner.on(facts);
    planner.on(execution);
    ActiveTrajectory active;
    active.position = q;
    active.velocity = Vector::Zero(robot->dof());
    if (moves && way.size() > 0) {
      const MotionState3 state = way.at(along);
      q = active.position = RobotModel::with(q, robot->require_group("arm"), state.position);
      active.velocity(robot->require_group("arm").axes) = state.velocity;
      active.trajectory = execution.trajectory;
      active.speed_factor = 1;
      active.time = along;
      active.rest = way;
      along = std::min(along + 0.02, way.duration());
      if (along >= way.duration()) execution.motion = MotionState::finished;
      planner.on(execution);
    }
    planner.on(active);
    Outbox out;
    planner.step(now, out);
    for (auto& job : out.jobs) {
      job();
      planner.job_done();
    }
    for (auto& request : out.grasp_requests) answer(request);
    for (auto& request : out.regrasp_requests) answer(request);
    for (auto& request : out.path_requests) answer(request);
    for (auto& request : out.trajectory_requests) answer(request);
    for (auto& command : out.trajectories) obey(command);
    for (auto& command : out.hand_commands) obey(command);
    if (execution.hand == HandState::moving && --opening == 0) execution.hand = HandState::idle;
    const bool offers = planner.status().phase == ActionPhase::offer;
    if (out.hand_commands.empty() && offers && person_takes) execution.hand = HandState::released;
  }

  void answer(const GraspRequest& request) {
    GraspReply reply;
    reply.id = request.id;
    Grasp grasp;
    grasp.id = 1;
    grasp.arm_joints = RobotModel::part(q, robot->require_group("arm"));
    grasp.arm_joints[0] += 0.2;
    grasp.approach_joints = grasp.arm_joints;
    grasp.approach_joints[1] += 0.1;
    grasp.hand_joints = grasp.pregrasp_joints = RobotModel::part(q, robot->require_group("hand"));
    grasp.pregrasp_joints[0] += opens_by;
    grasp.T_object_hand =
        scene.objects[0].T_world_object.inverse() * scene.T_world_base *
        robot->link_pose(RobotModel::with(q, robot->require_group("arm"), grasp.arm_joints),
                         robot->tool_link());
    if (!grasps.empty())
      reply.grasps = grasps;
    else if (grasps_exist)
      reply.grasps.push_back(grasp);
    else
      reply.reason = "no frame gives three contacts";
    if (grasp_planner_lives) planner.on(reply);
    if (after_grasp_reply) after_grasp_reply();
  }
  void answer(const RegraspRequest& request) {
    regrasps.push_back(request);
    RegraspReply reply;
    reply.id = request.id;
    reply.reason = "no sequence of grasps leads there";
    planner.on(reply);
  }
  void answer(const PathRequest& request) {
    last_path = request;
    path_groups.push_back(request.group);
    if (request.cancel || !path_planner_lives) return;
    ++path_requests;
    PathReply reply;
    reply.id = request.id;
    reply.solved = path_requests > failing_paths;
    if (request.group == kPlatformGroup && failing_drives > 0) {
      --failing_drives;
      reply.solved = false;
    }
    const bool allowed_to_touch =
        std::find(request.allowed_contacts.begin(), request.allowed_contacts.end(), touched) !=
        request.allowed_contacts.end();
    if (!touched.empty() && !allowed_to_touch && (request.start - touching_posture).norm() < 1e-9) {
      reply.solved = false;
      reply.start_touches = touched;
    }
    reply.reason = "goal 0 in collision: link forearm and box table";
    reply.path = {RobotModel::part(request.start, robot->require_group(request.group)),
                  request.goals.front()};
    if (!request.running.empty()) {
      const bool same_goal = (request.goals.front() - request.running.back()).norm() < 1e-9;
      reply.outcome = same_goal ? PathOutcome::kept : PathOutcome::replanned;
      if (same_goal) reply.path = request.running;
      led_over += same_goal ? 0 : 1;
    }
    planner.on(reply);
  }
  void answer(const TrajectoryRequest& request) {
    TrajectoryReply reply;
    reply.id = request.id;
    if (!request.poses.empty()) {
      reply.reason = "motions of the tool are not planned here";
      return planner.on(reply);
    }
    reply.solved = true;
    const std::vector<int>& moved = robot->require_group(request.group).axes;
    reply.axes.assign(moved.begin(), moved.end());
    target = request.nodes.back();
    if (moves) {
      KinematicLimits limits = robot->comfort_limits();
      const std::vector<int>& axes = robot->require_group("arm").axes;
      limits = {limits.velocity(axes), limits.acceleration(axes), limits.jerk(axes)};
      const std::vector<LimitZones> zones(request.nodes.size() - 1, LimitZones{{1, {speed_scale}}});
      reply.trajectory = smooth(request.nodes, limits, {}, {}, zones).trajectory;
      reply.speeds = Vector::Constant(static_cast<Eigen::Index>(zones.size()), speed_scale);
      return planner.on(reply);
    }
    for (int i = 0; i < target.size(); ++i)
      reply.trajectory.axes.push_back({{target[i], 0, 0}, {{1.0, 0.0}}});
    planner.on(reply);
  }
  void obey(const TrajectoryCommand& command) {
    phases.push_back(phase_text(planner.status()));
    allowed.push_back(command.allowed_contacts);
    execution.trajectory = command.id;
    if (moves) {
      commands.push_back(command);
      if (command.axes.empty()) {
        way = {};
        execution.motion = MotionState::stopped;
        return;
      }
      if (command.switch_at > 0) {
        const double offset = way.duration() - latest;
        way = cut(way, 0, command.switch_at + offset);
        jumps.push_back(
            (way.at(way.duration()).position - command.trajectory.at(0).position).norm() +
            (way.at(way.duration()).velocity - command.trajectory.at(0).velocity).norm());
        append(way, command.trajectory);
      } else {
        way = command.trajectory;
        along = 0;
      }
      latest = command.trajectory.duration();
      execution.motion = MotionState::running;
      return;
    }
    execution.motion = stops > 0 ? MotionState::stopped : MotionState::finished;
    if (stops > 0)
      --stops;
    else
      for (std::size_t i = 0; i < command.axes.size(); ++i)
        q[command.axes[i]] = target[static_cast<Eigen::Index>(i)];
  }
  void obey(const HandCommand& command) {
    execution.hand_command = command.id;
    hand_actions.push_back(command.action);
    execution.hand = command.action == HandAction::grasp
                         ? (grasp_holds && !unsure ? HandState::grasped : HandState::empty)
                     : command.action == HandAction::release_on_pull ? HandState::grasped
                     : opens_for > 0                                 ? HandState::moving
                                                                     : HandState::idle;
    opening = opens_for;
    if (command.action == HandAction::grasp && grasp_holds) {
      if (object_comes) scene.objects[0].holder = Holder::robot;
      T_tool_mug = grasped_as_it_stands ? Pose(tool().inverse() * scene.objects[0].T_world_object)
                                        : make_pose({0.08, 0.02, 0.23});
    }
  }
  void hold_out() {
    scene.objects[0].holder = Holder::human;
    scene.objects[0].holder_id = "anna";
    scene.objects[0].T_world_object = make_pose({0.95, 0.1, 1.1});
    facts.facts = {{FactKind::offering, "anna", "mug", 0.0, 1.0}};
  }
  void draw_back() {
    scene.objects[0].T_world_object = make_pose({1.25, 0.1, 1.1});
    facts.facts.clear();
  }
  void fails_to_pick(const std::string& reason, ActionFailure kind = ActionFailure::other) {
    start(ActionKind::pick);
    run(90);
    EXPECT_EQ(planner.status().state, ActionState::failed);
    EXPECT_NE(planner.status().reason.find(reason), std::string::npos) << planner.status().reason;
    EXPECT_EQ(planner.status().failure, kind) << name(planner.status().failure);
  }
  Pose tool() const { return scene.T_world_base * robot->link_pose(q, robot->tool_link()); }

  std::shared_ptr<const RobotModel> robot;
  ObjectModel mug;
  ManipulationPlanner planner;
  Scene scene;
  HumanState people;
  Facts facts;
  ExecutionStatus execution;
  Vector q, target;
  std::string touched;  // object that the robot touches in touching_posture
  Vector touching_posture;
  Pose T_tool_mug{Pose::Identity()};
  bool grasped_as_it_stands{false};
  bool unsure{false};  // the hand reports no contact even if the object is held
  TimePoint now{};
  std::uint64_t actions{0};
  std::function<void()> after_grasp_reply;
  int path_requests{0}, failing_paths{0}, failing_drives{0}, stops{0}, led_over{0};
  PathRequest last_path;
  std::vector<RegraspRequest> regrasps;  // all requests, each answered without a sequence
  std::vector<std::string> path_groups;  // of all path requests
  std::vector<Grasp> grasps;             // the planner's answer; empty: one grasp near the arm
  bool grasps_exist{true}, grasp_planner_lives{true}, path_planner_lives{true}, grasp_holds{true},
      object_comes{true}, person_takes{true};
  std::vector<std::string> phases;
  std::vector<std::vector<std::string>> allowed;
  std::vector<HandAction> hand_actions;  // of all hand commands
  int opens_for{}, opening{};            // cycles of a commanded hand motion, total and remaining
  double opens_by{};                     // opening of the first hand axis before a grasp [rad]
  bool moves{};                          // trajectories take time, paths stay unchanged
  double speed_scale{1};                 // scale of the velocity limits due to people
  Trajectory way;                        // the running trajectory
  double along{}, latest{};
  std::vector<TrajectoryCommand> commands;
  std::vector<double> jumps;  // at the switch between two commands
};

}  // namespace handsel::manipulation_planner::rig
