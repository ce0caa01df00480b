#include "components/manipulation_planner/manipulation_planner.hpp"

#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "common/model/human_body.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/smooth.hpp"
#include "tests/support/cost_layer.hpp"

namespace handsel::manipulation_planner {
namespace {

config::ManipulationPlannerSettings settings() {
  config::ManipulationPlannerSettings s;
  load_text_proto(resource("config/manipulation_planner.txtpb"), s);
  return s;
}

// Plays the planners and the controller: every request is answered at once unless the test says otherwise, every trajectory reaches its
// end.
class Rig {
 public:
  Rig()
      : robot(std::make_shared<RobotModel>(RobotModel::load(robot_description("jido")))),
        mug(ObjectModel::load(object_description("mug"))),
        planner(
            settings(), robot, [this](const std::string& name) { return name == "mug" ? &mug : nullptr; }, 1000) {
    q = robot->rest_posture();
    scene.robot_known = true;
    scene.T_world_base = Pose::Identity();
    scene.boxes.push_back({"table", make_pose({0.7, -0.6, 0.35}), {0.6, 0.6, 0.7}, true});
    scene.objects.push_back({"mug", "mug", make_pose({0.7, -0.6, 0.75}), Holder::surface, "table", 0});
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

  void run(double duration) {
    for (double t = 0; t < duration && (t < 0.1 || planner.status().state == ActionState::running); t += 0.02) cycle();
  }

  void run_until(const std::string& phase) {
    for (int i = 0; i < 1500 && planner.status().phase != phase; ++i) cycle();
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
    for (auto& request : out.path_requests) answer(request);
    for (auto& request : out.trajectory_requests) answer(request);
    for (auto& command : out.trajectories) obey(command);
    for (auto& command : out.hand_commands) obey(command);
    if (out.hand_commands.empty() && planner.status().phase == "offer" && person_takes) execution.hand = HandState::released;
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
    grasp.T_object_hand = scene.objects[0].T_world_object.inverse() * scene.T_world_base *
                          robot->link_pose(RobotModel::with(q, robot->require_group("arm"), grasp.arm_joints), robot->tool_link());
    if (grasps_exist)
      reply.grasps.push_back(grasp);
    else
      reply.reason = "no frame gives three contacts";
    if (grasp_planner_lives) planner.on(reply);
  }
  void answer(const PathRequest& request) {
    last_path = request;
    if (request.cancel || !path_planner_lives) return;
    ++path_requests;
    PathReply reply;
    reply.id = request.id;
    reply.solved = path_requests > failing_paths;
    const bool allowed_to_touch =
        std::find(request.allowed_contacts.begin(), request.allowed_contacts.end(), touched) != request.allowed_contacts.end();
    if (!touched.empty() && !allowed_to_touch && (request.start - touching_posture).norm() < 1e-9) {
      reply.solved = false;
      reply.start_touches = touched;
    }
    reply.reason = "goal 0 in collision: link forearm and box table";
    reply.path = {RobotModel::part(request.start, robot->require_group("arm")), request.goals.front()};
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
    reply.solved = true;
    target = request.nodes.back();
    if (moves) {
      KinematicLimits limits = robot->comfort_limits();
      const std::vector<int>& axes = robot->require_group("arm").axes;
      limits = {limits.velocity(axes), limits.acceleration(axes), limits.jerk(axes)};
      const std::vector<SpeedZones> zones(request.nodes.size() - 1, SpeedZones{{1, share}});
      reply.trajectory = smooth(request.nodes, limits, {}, {}, zones).trajectory;
      reply.speeds = Vector::Constant(static_cast<Eigen::Index>(zones.size()), share);
      return planner.on(reply);
    }
    for (int i = 0; i < target.size(); ++i) reply.trajectory.axes.push_back({{target[i], 0, 0}, {{1.0, 0.0}}});
    planner.on(reply);
  }
  void obey(const TrajectoryCommand& command) {
    phases.push_back(planner.status().phase);
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
        jumps.push_back((way.at(way.duration()).position - command.trajectory.at(0).position).norm() +
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
      q = RobotModel::with(q, robot->require_group("arm"), target);
  }
  void obey(const HandCommand& command) {
    execution.hand_command = command.id;
    execution.hand = command.action == HandAction::grasp             ? (grasp_holds ? HandState::grasped : HandState::empty)
                     : command.action == HandAction::release_on_pull ? HandState::grasped
                                                                     : HandState::idle;
    if (command.action == HandAction::grasp && grasp_holds) {
      if (object_comes) scene.objects[0].holder = Holder::robot;
      T_tool_mug = grasped_as_it_stands ? Pose(tool().inverse() * scene.objects[0].T_world_object) : make_pose({0.08, 0.02, 0.23});
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
  void fails_to_pick(const std::string& reason) {
    start(ActionKind::pick);
    run(90);
    EXPECT_EQ(planner.status().state, ActionState::failed);
    EXPECT_NE(planner.status().reason.find(reason), std::string::npos) << planner.status().reason;
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
  std::string touched;  // by the robot as long as it is in touching_posture
  Vector touching_posture;
  Pose T_tool_mug{Pose::Identity()};
  bool grasped_as_it_stands{false};
  TimePoint now{};
  std::uint64_t actions{0};
  int path_requests{0}, failing_paths{0}, stops{0}, led_over{0};
  PathRequest last_path;
  bool grasps_exist{true}, grasp_planner_lives{true}, path_planner_lives{true}, grasp_holds{true}, object_comes{true}, person_takes{true};
  std::vector<std::string> phases;
  std::vector<std::vector<std::string>> allowed;
  bool moves{};     // trajectories take their time, paths are kept
  double share{1};  // of the velocity limits, because of people
  Trajectory way;   // that runs
  double along{}, latest{};
  std::vector<TrajectoryCommand> commands;
  std::vector<double> jumps;  // where one command took over from another
};

TEST(ManipulationPlanner, PicksByApproachReachGraspAndLift) {
  Rig rig;
  rig.start(ActionKind::pick);
  rig.run(30);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_TRUE(rig.planner.status().holding);
  EXPECT_EQ(rig.phases, (std::vector<std::string>{"approach", "reaching the object", "lift"}));
}

TEST(ManipulationPlanner, TheObjectRisesWhenLifted) {
  Rig rig;
  rig.start(ActionKind::pick);
  double before = 0;
  for (int i = 0; i < 1500 && rig.planner.status().state == ActionState::running; ++i) {
    if (rig.planner.status().phase == "grasp") before = rig.tool().translation().z();
    rig.cycle();
  }
  EXPECT_GT(rig.tool().translation().z() - before, 0.1);
}

TEST(ManipulationPlanner, GivesWithinReachOfThePersonAndEngagesThemOnlyAtTheOffer) {
  Rig rig;
  rig.start(ActionKind::pick);
  rig.run(30);
  rig.start(ActionKind::give);
  bool engaged_before_offer = false, engaged_at_offer = false;
  for (int i = 0; i < 2000 && (i < 5 || rig.planner.status().state == ActionState::running); ++i) {
    const ActionStatus& status = rig.planner.status();
    if (status.phase == "carry") engaged_before_offer |= status.exchange_engaged;
    if (status.phase == "offer") engaged_at_offer |= status.exchange_engaged;
    rig.cycle();
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_FALSE(engaged_before_offer);
  EXPECT_TRUE(engaged_at_offer);
  EXPECT_TRUE(within_reach(rig.people.people[0], rig.planner.status().exchange_point));
  EXPECT_FALSE(rig.planner.status().holding);
  EXPECT_EQ(rig.phases.back(), "retreat");
  EXPECT_NE(std::find(rig.allowed.back().begin(), rig.allowed.back().end(), "anna"), rig.allowed.back().end());
}

TEST(ManipulationPlanner, AnOfferNobodyTakesFailsWithTheirName) {
  Rig rig;
  rig.start(ActionKind::pick);
  rig.run(30);
  rig.person_takes = false;
  rig.start(ActionKind::give);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_NE(rig.planner.status().reason.find("anna did not take mug"), std::string::npos) << rig.planner.status().reason;
  EXPECT_TRUE(rig.planner.status().holding);
}

TEST(ManipulationPlanner, AMotionThatIsStoppedIsPlannedAgain) {
  Rig rig;
  rig.stops = 2;
  rig.start(ActionKind::go_to);
  rig.run(30);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_EQ(rig.path_requests, 3);
}

TEST(ManipulationPlanner, FromAPersonItTouchesItDrawsBackFirst) {
  Rig rig;
  rig.touched = "anna";
  rig.touching_posture = rig.q;
  const Vector3 torso = rig.people.people[0].joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  const double before = (rig.tool().translation() - torso).norm();
  rig.start(ActionKind::go_to);
  double farthest = before;
  for (int i = 0; i < 500 && (i < 5 || rig.planner.status().state == ActionState::running); ++i) {
    rig.cycle();
    farthest = std::max(farthest, (rig.tool().translation() - torso).norm());
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_EQ(rig.phases, (std::vector<std::string>{"drawing back", "to rest"}));
  EXPECT_EQ(rig.allowed.front(), std::vector<std::string>{"anna"});
  EXPECT_TRUE(rig.allowed.back().empty());
  EXPECT_GT(farthest, before + 0.03);
}

TEST(ManipulationPlanner, AKeptPathIsTimedAnewWhenPeopleComeNearAndWhenTheyLeave) {
  Rig rig;
  rig.people.people.clear();
  rig.scene.boxes.clear();
  rig.scene.objects.clear();
  rig.moves = true;
  rig.q[rig.robot->require_group("arm").axes[0]] += 2.2;
  rig.start(ActionKind::go_to);
  const auto left = [&] { return rig.way.duration() - rig.along; };
  const auto runs = [&](double duration) {
    for (double t = 0; t < duration && (rig.way.size() == 0 || left() > 0.02); t += 0.02) rig.cycle();
  };
  runs(1.0);
  EXPECT_EQ(rig.commands.size(), 1u);
  EXPECT_GT(rig.planner.live_counts().kept, 1u);
  EXPECT_EQ(rig.planner.live_counts().retimed, 0u);
  const double before = left();
  rig.share = 0.5;  // somebody has come near
  runs(0.6);
  const auto& counts = rig.planner.live_counts();
  ASSERT_EQ(rig.commands.size(), 2u) << counts.looks << " looks, " << counts.refused << " refused";
  EXPECT_GT(left() + 0.6, before + 0.4);
  rig.share = 0.97;  // and has gone
  const double slow = left();
  EXPECT_GT(slow, 2) << "the test needs a longer way";
  runs(0.6);
  ASSERT_EQ(rig.commands.size(), 3u) << counts.looks << " looks, " << counts.refused << " refused";
  EXPECT_LT(left() + 0.6, slow - 0.2);
  EXPECT_EQ(rig.planner.live_counts().retimed, 2u);
  for (const double jump : rig.jumps) EXPECT_LT(jump, 1e-9);
  runs(20);
  EXPECT_EQ(rig.commands.size(), 3u);
  rig.run(1);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
}

TEST(ManipulationPlanner, SaysWhatStoodInTheWayAndWhatItTried) {
  Rig rig;
  rig.failing_paths = 1000;
  rig.start(ActionKind::go_to);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_NE(rig.planner.status().reason.find("forearm"), std::string::npos);
  EXPECT_FALSE(rig.planner.status().refusals.empty());
}

TEST(ManipulationPlanner, NoGraspsIsAReasonNotACrash) {
  Rig rig;
  rig.grasps_exist = false;
  rig.fails_to_pick("three contacts");
}

TEST(ManipulationPlanner, ADeadPlannerIsAskedAgainAndNamedInTheEnd) {
  Rig rig;
  rig.grasp_planner_lives = false;
  rig.fails_to_pick("grasp planner");
}

TEST(ManipulationPlanner, AnEmptyHandBacksOffAndSaysSo) {
  Rig rig;
  rig.grasp_holds = false;
  rig.fails_to_pick("closed on nothing");
  EXPECT_EQ(rig.phases.back(), "backing off");
}

TEST(ManipulationPlanner, WhatStaysBehindWhenTheHandGoesUpIsNotHeld) {
  Rig rig;
  rig.object_comes = false;
  rig.fails_to_pick("stayed behind");
  EXPECT_FALSE(rig.planner.status().holding);
  EXPECT_GT(std::count(rig.phases.begin(), rig.phases.end(), "lift"), 1) << "it is tried again";
}

TEST(ManipulationPlanner, WhatSlipsOutOfTheHandEndsTheActionWithThatReason) {
  for (const bool to_a_person : {false, true}) {
    Rig rig;
    rig.start(ActionKind::pick);
    rig.run(30);
    ASSERT_TRUE(rig.planner.status().holding);
    rig.person_takes = false;
    rig.start(ActionKind::give);
    rig.run_until("offer");
    SceneObject& mug = rig.scene.objects[0];
    mug.holder = to_a_person ? Holder::human : Holder::nobody;
    mug.holder_id = to_a_person ? "anna" : "";
    mug.T_world_object.translation().z() = 0.05;
    for (int i = 0; i < 20; ++i) rig.cycle();
    const ActionStatus& status = rig.planner.status();
    if (to_a_person) {
      EXPECT_EQ(status.state, ActionState::running) << status.reason;
      continue;
    }
    EXPECT_EQ(status.state, ActionState::failed);
    EXPECT_EQ(status.reason, "mug slipped out of the hand (offer)");
    EXPECT_FALSE(status.holding);
  }
}

TEST(ManipulationPlanner, CancelledInMidMotionItSaysSoStopsTheArmAndTakesTheNextAction) {
  Rig rig;
  rig.moves = true;
  rig.q[rig.robot->require_group("arm").axes[0]] += 1.0;
  rig.start(ActionKind::go_to);
  for (int i = 0; i < 50 && rig.commands.empty(); ++i) rig.cycle();
  for (int i = 0; i < 5; ++i) rig.cycle();
  ASSERT_EQ(rig.commands.size(), 1u);
  ActionGoal cancel;
  cancel.id = rig.actions;
  cancel.cancel = true;
  rig.planner.on(cancel);
  EXPECT_EQ(rig.planner.status().state, ActionState::cancelled);
  rig.execution.mode = Mode::hold;
  for (int i = 0; i < 20; ++i) rig.cycle();
  ASSERT_EQ(rig.commands.size(), 2u) << "heard once is enough";
  EXPECT_TRUE(rig.commands.back().axes.empty());
  rig.execution.mode = Mode::normal;
  rig.start(ActionKind::go_to);
  rig.run(10);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded);
}

TEST(ManipulationPlanner, WithTheActionGoesWhatItHasAskedThePathPlannerFor) {
  for (const bool replaced : {false, true}) {
    Rig rig;
    rig.path_planner_lives = false;
    rig.start(ActionKind::go_to);
    rig.run(0.5);
    const RequestId asked = rig.last_path.id;
    ASSERT_FALSE(rig.last_path.cancel);
    if (replaced) {
      rig.execution.mode = Mode::hold;  // so that the next one asks for nothing yet
      rig.start(ActionKind::go_to);
    } else {
      ActionGoal cancel;
      cancel.id = rig.actions;
      cancel.cancel = true;
      rig.planner.on(cancel);
    }
    rig.cycle();
    EXPECT_TRUE(rig.last_path.cancel);
    EXPECT_EQ(rig.last_path.id, asked);
    rig.last_path = {};
    rig.cycle();
    EXPECT_FALSE(rig.last_path.cancel) << "once is enough";
  }
  Rig rig;
  rig.start(ActionKind::go_to);
  rig.run(10);
  ASSERT_EQ(rig.planner.status().state, ActionState::succeeded);
  rig.start(ActionKind::go_to);
  rig.execution.mode = Mode::hold;
  rig.cycle();
  EXPECT_FALSE(rig.last_path.cancel) << "all was answered";
}

TEST(ManipulationPlanner, TakesWhatAPersonHoldsOutAndEngagesThemOnlyWhileTheyOffer) {
  Rig rig;
  rig.start(ActionKind::receive);
  rig.run(1);
  EXPECT_EQ(rig.planner.status().phase, "watching for an offer");
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  rig.hold_out();
  bool engaged = false;
  for (int i = 0; i < 1000 && rig.planner.status().state == ActionState::running; ++i) {
    rig.cycle();
    if (rig.planner.status().phase == "reaching the object") engaged = rig.planner.status().exchange_engaged;
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_TRUE(engaged);
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  EXPECT_TRUE(rig.planner.status().holding);
  EXPECT_EQ(rig.phases, (std::vector<std::string>{"approach", "reaching the object", "retreat"}));
}

TEST(ManipulationPlanner, WhatNobodyOffersIsNotTaken) {
  Rig rig;
  rig.scene.objects[0].holder = Holder::human;
  rig.scene.objects[0].holder_id = "anna";
  rig.draw_back();
  rig.start(ActionKind::receive);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "anna does not offer mug within 30 s");
  EXPECT_EQ(rig.phases, std::vector<std::string>{"making room"}) << "it moved toward them";
}

TEST(ManipulationPlanner, WhoWasAskedForItOffersItWithABentArmToo) {
  Rig rig;
  rig.hold_out();
  rig.facts.facts.clear();
  rig.start(ActionKind::receive);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
}

TEST(ManipulationPlanner, AnOfferThatIsShiftedIsFollowedWhileTheArmMoves) {
  Rig rig;
  rig.moves = true;
  rig.share = 0.15;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  ASSERT_EQ(rig.planner.status().phase, "approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.scene.objects[0].T_world_object.translation().y() += 0.03;
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_GT(rig.led_over, 0) << "nobody asked for a way to where it is now";
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "backing off"), 0);
}

TEST(ManipulationPlanner, ForeseesWhenTheObjectChangesHands) {
  Rig rig;
  rig.moves = true;
  rig.hold_out();
  rig.start(ActionKind::receive);
  double at_first = 0, closed_at = 0, foreseen_at = 0;
  for (int i = 0; i < 1500 && rig.planner.status().state == ActionState::running; ++i) {
    rig.cycle();
    const double left = rig.planner.status().time_to_exchange, now = to_seconds(rig.now.time_since_epoch());
    const std::string& phase = rig.planner.status().phase;
    const bool waits = phase == "watching for an offer" || phase == "making room";
    EXPECT_FALSE(waits && std::isfinite(left)) << phase;
    if (phase == "approach" && std::isfinite(left) && at_first == 0) {
      at_first = left;
      foreseen_at = now + left;
    }
    if (phase == "grasp" && closed_at == 0) closed_at = now;
  }
  ASSERT_GT(at_first, 0.5);
  ASSERT_GT(closed_at, 0);
  EXPECT_NEAR(foreseen_at, closed_at, 2.0);
  EXPECT_FALSE(std::isfinite(rig.planner.status().time_to_exchange)) << "it is over";
}

TEST(ManipulationPlanner, WhatIsPutIntoTheOpenHandOnItsWayIsHeldAtOnce) {
  Rig rig;
  rig.moves = true;
  rig.share = 0.15;
  rig.hold_out();
  Vector grasping = rig.q;
  grasping[rig.robot->require_group("arm").axes.front()] += 0.2;  // as the rig answers
  rig.T_tool_mug =
      (rig.scene.T_world_base * rig.robot->link_pose(grasping, rig.robot->tool_link())).inverse() * rig.scene.objects[0].T_world_object;
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.scene.objects[0].holder = Holder::robot;
  rig.facts.facts.clear();
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_TRUE(rig.planner.status().holding);
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "reaching the object"), 0);
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "drawing back"), 0);
}

TEST(ManipulationPlanner, WhatIsDrawnBackIsNotGoneAfter) {
  Rig rig;
  rig.moves = true;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.draw_back();
  rig.run_until("watching for an offer");
  EXPECT_EQ(rig.planner.status().phase, "watching for an offer");
  ASSERT_FALSE(rig.planner.status().refusals.empty());
  EXPECT_EQ(rig.planner.status().refusals.back().reason, "anna has drawn mug back");
}

TEST(ManipulationPlanner, WhereFingersAreInTheWayOfTheHandItDoesNotGo) {
  Rig rig;
  rig.hold_out();
  Person& anna = rig.people.people.front();
  rig.start(ActionKind::receive);
  for (int i = 0; i < 3000 && rig.planner.status().state != ActionState::failed; ++i) {
    Vector at = rig.q;
    at[rig.robot->require_group("arm").axes.front()] += 0.2;  // as the rig answers
    const Vector3 p = rig.robot->link_pose(at, rig.robot->tool_link()).translation();
    for (const char* joint : {"r_hand", "r_wrist"}) anna.joints[static_cast<std::size_t>(body_joint_index(joint))].position = p;
    rig.cycle();
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "the hand would come too near to the fingers of anna");
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "approach"), 0);
}

TEST(ManipulationPlanner, FromAnOfferThatIsMovedAwayItBacksOffWithTheHandOpened) {
  Rig rig;
  rig.moves = true;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until("reaching the object");
  ASSERT_EQ(rig.planner.status().phase, "reaching the object");
  for (int i = 0; i < 10; ++i) rig.cycle();
  rig.draw_back();
  rig.run_until("watching for an offer");
  EXPECT_EQ(rig.planner.status().phase, "watching for an offer");
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "backing off"), 1);
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  EXPECT_FALSE(rig.planner.status().holding);
  ASSERT_FALSE(rig.planner.status().refusals.empty());
  EXPECT_EQ(rig.planner.status().refusals.back().reason, "mug was moved away");
}

TEST(ManipulationPlanner, WhoDoesNotLetGoKeepsIt) {
  Rig rig;
  rig.object_comes = false;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run(200);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "anna does not let go of mug");
  EXPECT_EQ(rig.phases.back(), "backing off");
  EXPECT_FALSE(rig.planner.status().holding);
}

TEST(ManipulationPlanner, PlacesWhatItHoldsOnTheSurface) {
  Rig rig;
  Vector at_grasp = rig.q;  // as the rig answers
  at_grasp[rig.robot->require_group("arm").axes[0]] += 0.2;
  const Vector3 mug = rig.robot->link_pose(at_grasp, rig.robot->tool_link()).translation() - Vector3(0, 0, 0.3);
  rig.scene.objects[0].T_world_object = make_pose(mug);
  rig.grasped_as_it_stands = true;
  rig.scene.boxes[0] = {"table", make_pose({mug.x(), mug.y(), mug.z() - 0.16}), {0.5, 0.5, 0.1}, true};
  rig.start(ActionKind::pick);
  rig.run(30);
  rig.start(ActionKind::place);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_FALSE(rig.planner.status().holding);
}

class Exchange : public ::testing::Test {
 protected:
  ExchangeSearch find(const LayersNow& layers = {}, const std::vector<config::PersonProfile>& people = {}) {
    auto many = settings();
    many.set_w_preference(0.4);
    for (const config::PersonProfile& profile : people) *many.add_people() = profile;
    many.set_exchange_goals(20);
    return find_exchange(*rig_.robot, rig_.scene, anna_, layers, rig_.q, rig_.tool() * rig_.T_tool_mug, make_pose({0.08, 0.02, 0.23}),
                         many);
  }
  Rig rig_;
  Person& anna_{rig_.people.people[0]};
};

TEST_F(Exchange, places_under_a_table_are_none) {
  const ExchangeSearch before = find();
  ASSERT_FALSE(before.poses.empty()) << before.reason;
  const double middle = before.poses.front().T_world_object.translation().z();
  rig_.scene.boxes.push_back({"high table", make_pose({0.95, 0, middle + 0.1}), {0.9, 2, 0.04}, true});
  const ExchangeSearch search = find();
  for (const ExchangePose& pose : search.poses) EXPECT_GT(pose.T_world_object.translation().z(), middle + 0.1) << "under or in the table";
}

TEST_F(Exchange, is_where_the_profile_of_the_person_says) {
  const auto across_and_away = [&](const config::PersonProfile& profile) {
    const ExchangeSearch search = find({}, {profile});
    EXPECT_FALSE(search.poses.empty()) << search.reason;
    const auto joint = [&](const char* name) { return anna_.joints[static_cast<std::size_t>(body_joint_index(name))].position; };
    const Vector3 from_torso = search.poses.front().T_world_object.translation() - joint("torso");
    return std::pair(from_torso.dot((joint("l_shoulder") - joint("r_shoulder")).normalized()), from_torso.head<2>().norm());
  };
  config::PersonProfile profile;
  profile.set_id(anna_.id);
  profile.set_handed(config::LEFT);
  EXPECT_GT(across_and_away(profile).first, -1e-6);
  profile.set_handed(config::RIGHT);
  EXPECT_LT(across_and_away(profile).first, 1e-6);
  profile.set_handed(config::EITHER);
  profile.set_preferred_distance(0.45);
  const double near = across_and_away(profile).second;
  profile.set_preferred_distance(0.8);
  EXPECT_GT(across_and_away(profile).second, near + 0.05);
  const double usual = find().poses.front().cost;
  profile.set_id("somebody else");
  EXPECT_EQ(find({}, {profile}).poses.front().cost, usual);
}

TEST_F(Exchange, behind_a_wall_there_is_none_and_the_reason_says_so) {
  ASSERT_FALSE(find().poses.empty());
  rig_.scene.boxes.push_back({"glass", make_pose({1.2, 0, 1}), {0.02, 4, 3}, false});
  const ExchangeSearch search = find();
  EXPECT_TRUE(search.poses.empty());
  EXPECT_NE(search.reason.find("behind furniture"), std::string::npos) << search.reason;
}

TEST_F(Exchange, keeps_off_what_a_layer_from_outside_forbids_and_costs) {
  const ExchangeSearch before = find();
  ASSERT_FALSE(before.poses.empty());
  const Vector3 best = before.poses.front().T_world_object.translation(), room(3, 3, 3), near(0.12, 0.12, 0.12);
  for (const std::uint8_t value : {std::uint8_t{254}, std::uint8_t{255}}) {
    LayersNow layers;
    layers.outside = {
        std::make_shared<const CostGrid>(test::box_layer("crowd", best - room, best + room, best - near, best + near, value, 5))};
    const ExchangeSearch search = find(layers);
    ASSERT_FALSE(search.poses.empty()) << search.reason;
    EXPECT_FALSE(((search.poses.front().T_world_object.translation() - best).cwiseAbs() - near).maxCoeff() < 0);
  }
  LayersNow everywhere;
  everywhere.outside = {
      std::make_shared<const CostGrid>(test::box_layer("crowd", best - room, best + room, best - room, best + room, 255, 1))};
  const ExchangeSearch nowhere = find(everywhere);
  EXPECT_TRUE(nowhere.poses.empty());
  EXPECT_NE(nowhere.reason.find("forbidden by a cost layer"), std::string::npos) << nowhere.reason;
}

TEST_F(Exchange, arm_comfort_comes_from_the_map_of_that_person) {
  const ExchangeSearch before = find();
  const Vector3 best = before.poses.front().T_world_object.translation(), room(1, 1, 1);
  Costmap map = test::box_layer("arm_comfort", best - room, best + room, best - room, best + room, 255, 1);
  LayersNow layers;
  map.person = "ben";
  layers.comfort = std::make_shared<const CostGrid>(map);
  EXPECT_EQ(find(layers).poses.size(), before.poses.size()) << "somebody else's";
  map.person = anna_.id;
  layers.comfort = std::make_shared<const CostGrid>(map);
  EXPECT_TRUE(find(layers).poses.empty()) << "out of reach everywhere";
}

}  // namespace
}  // namespace handsel::manipulation_planner
