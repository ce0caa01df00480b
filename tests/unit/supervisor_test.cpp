#include "components/supervisor/supervisor.hpp"

#include <gtest/gtest.h>

namespace handsel::supervisor {
namespace {

config::SupervisorSettings settings() {
  config::SupervisorSettings s;
  s.set_period(0.02);
  s.set_go_period(0.1);
  s.set_status_period(0.5);
  s.set_goal_retry(0.5);
  s.set_health_timeout(0.3);
  s.set_resume_delay(0.1);
  s.set_person_timeout(2.0);
  s.add_required("spark");
  s.set_speed_override(1.0);
  return s;
}

// Plays the rest of the system: spark is alive, the controller obeys Go, the manipulation planner does what the test tells it.
class Rig {
 public:
  Rig() : supervisor(settings(), 100) {
    facts.facts.push_back({FactKind::on_surface, "mug", "table", 1, 0});
    supervisor.on(facts, now);
  }

  void see(const std::string& person) {
    facts.facts.push_back({FactKind::attentive, person, "", 1, 0});
    supervisor.on(facts, now);
  }

  void run(double duration) {
    for (double t = 0; t < duration; t += 0.02) {
      now += from_seconds(0.02);
      if (spark_alive) {
        ComponentHealth health;
        health.component = "spark";
        health.state = HealthState::ok;
        supervisor.on(health, now);
      }
      supervisor.on(execution, now);
      if (action) supervisor.on(*action, now);
      Outbox out;
      supervisor.step(now, out);
      if (out.go) {
        go = *out.go;
        execution.mode = go.allowed && go.epoch > execution.epoch ? Mode::normal : (go.allowed ? execution.mode : Mode::hold);
        execution.epoch = go.epoch;
      }
      for (auto& goal : out.action_goals) goals.push_back(goal);
      for (auto& status : out.task_statuses) statuses.push_back(status);
    }
  }

  void give(std::uint64_t id, const std::string& to = "anna") {
    TaskGoal goal;
    goal.id = id;
    goal.kind = TaskKind::give;
    goal.object = "mug";
    goal.human = to;
    supervisor.on(goal, now);
  }

  void end_action(ActionState state, const std::string& reason = "", bool holding = false) {
    ActionStatus status;
    status.id = goals.back().id;
    status.state = state;
    status.reason = reason;
    status.holding = holding;
    action = status;
    run(0.1);
  }

  const TaskStatus& last() const { return statuses.back(); }

  TimePoint now{};
  Facts facts;
  Supervisor supervisor;
  ExecutionStatus execution;
  std::optional<ActionStatus> action;
  bool spark_alive{true};
  Go go;
  std::vector<ActionGoal> goals;
  std::vector<TaskStatus> statuses;
};

TEST(Supervisor, GivesAMugInThreeActionsOneAfterTheOther) {
  Rig rig;
  rig.run(0.5);
  EXPECT_TRUE(rig.go.allowed);
  rig.give(1);
  rig.run(0.1);
  ASSERT_EQ(rig.goals.size(), 1u);
  EXPECT_EQ(rig.goals[0].kind, ActionKind::pick);
  rig.end_action(ActionState::succeeded, "", true);
  ASSERT_EQ(rig.goals.size(), 2u);
  EXPECT_EQ(rig.goals[1].kind, ActionKind::give);
  EXPECT_EQ(rig.goals[1].human, "anna");
  rig.end_action(ActionState::succeeded);
  ASSERT_EQ(rig.goals.size(), 3u);
  EXPECT_EQ(rig.goals[2].kind, ActionKind::go_to);
  rig.end_action(ActionState::succeeded);
  EXPECT_EQ(rig.last().state, TaskState::succeeded);
  EXPECT_EQ(rig.last().plan.size(), 3u);
}

TEST(Supervisor, AGiftForNobodyInParticularWaitsForSomebodyAndIsPickedForThem) {
  Rig rig;
  rig.run(0.5);
  rig.give(1, "");
  rig.run(1.0);
  EXPECT_TRUE(rig.goals.empty());
  EXPECT_EQ(rig.last().phase, "looking for somebody");
  rig.see("bert");
  rig.run(0.1);
  ASSERT_EQ(rig.goals.size(), 1u);
  EXPECT_EQ(rig.goals[0].kind, ActionKind::pick);
  EXPECT_EQ(rig.goals[0].human, "bert");
  EXPECT_EQ(rig.last().plan[1], "give mug to bert");
}

TEST(Supervisor, WhenNobodyComesTheGiftFailsBeforeAnythingMoves) {
  Rig rig;
  rig.run(0.5);
  rig.give(1, "");
  rig.run(2.2);
  EXPECT_TRUE(rig.goals.empty());
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_NE(rig.last().reason.find("nobody is in sight"), std::string::npos) << rig.last().reason;
}

TEST(Supervisor, AnUntakenObjectIsPutBackAndTheTaskFailsWithTheFirstReason) {
  Rig rig;
  rig.run(0.5);
  rig.give(1);
  rig.run(0.1);
  rig.end_action(ActionState::succeeded, "", true);
  rig.end_action(ActionState::failed, "anna did not take mug", true);
  ASSERT_EQ(rig.goals.back().kind, ActionKind::place);
  EXPECT_EQ(rig.goals.back().surface, "table");
  rig.end_action(ActionState::succeeded);
  EXPECT_EQ(rig.goals.back().kind, ActionKind::go_to);
  rig.end_action(ActionState::succeeded);
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_NE(rig.last().reason.find("anna did not take mug"), std::string::npos);
}

TEST(Supervisor, AnActionGoalIsRepeatedUntilTakenUp) {
  Rig rig;
  rig.run(0.5);
  rig.give(1);
  rig.run(1.2);
  ASSERT_GE(rig.goals.size(), 2u);
  EXPECT_EQ(rig.goals.front().id, rig.goals.back().id);
}

TEST(Supervisor, TheSameGoalTwiceIsOneTaskAndAnotherIsRefusedWhileBusy) {
  Rig rig;
  rig.run(0.5);
  rig.give(1);
  rig.give(1);
  rig.run(0.1);
  rig.give(2);
  rig.run(0.1);
  int refused = 0;
  for (const auto& status : rig.statuses) refused += status.state == TaskState::refused;
  EXPECT_EQ(refused, 1);
}

TEST(Supervisor, AnUnknownKindOfTaskIsRefusedWithAReason) {
  Rig rig;
  rig.run(0.5);
  TaskGoal goal;
  goal.id = 5;
  goal.kind = TaskKind::tidy;
  rig.supervisor.on(goal, rig.now);
  rig.run(0.1);
  EXPECT_EQ(rig.last().state, TaskState::refused);
  EXPECT_NE(rig.last().reason.find("tidy"), std::string::npos);
}

TEST(Supervisor, CancelStopsTheActionAndEndsTheTask) {
  Rig rig;
  rig.run(0.5);
  rig.give(1);
  rig.run(0.1);
  TaskGoal cancel;
  cancel.id = 2;
  cancel.kind = TaskKind::cancel;
  rig.supervisor.on(cancel, rig.now);
  rig.run(0.1);
  EXPECT_TRUE(rig.goals.back().cancel);
  bool cancelled = false;
  for (const auto& status : rig.statuses) cancelled |= status.id == 1 && status.state == TaskState::cancelled;
  EXPECT_TRUE(cancelled);
}

TEST(Permission, IsWithdrawnWhenARequiredComponentIsGoneButOnlyAfterTheTrajectoryEnded) {
  Rig rig;
  rig.run(0.5);
  ASSERT_TRUE(rig.go.allowed);
  rig.execution.motion = MotionState::running;
  rig.spark_alive = false;
  rig.run(0.6);
  EXPECT_TRUE(rig.go.allowed);
  rig.execution.motion = MotionState::finished;
  rig.run(0.2);
  EXPECT_FALSE(rig.go.allowed);
  EXPECT_NE(rig.go.reason.find("spark"), std::string::npos);
  rig.spark_alive = true;
  const auto epoch = rig.go.epoch;
  rig.run(0.5);
  EXPECT_TRUE(rig.go.allowed);
  EXPECT_GT(rig.go.epoch, epoch);
}

TEST(Permission, AfterAFaultOnlyAPersonResumes) {
  Rig rig;
  rig.run(0.5);
  rig.execution.mode = Mode::fault;
  const auto epoch = rig.go.epoch;
  rig.run(1.0);
  EXPECT_EQ(rig.go.epoch, epoch);
  TaskGoal acknowledge;
  acknowledge.id = 9;
  acknowledge.kind = TaskKind::acknowledge;
  rig.supervisor.on(acknowledge, rig.now);
  rig.run(0.3);
  EXPECT_GT(rig.go.epoch, epoch);
}

TEST(Permission, APersonsWordReachesADriveThatWaitsForItAndPermissionComesAfter) {
  Rig rig;
  rig.run(0.5);
  rig.execution.mode = Mode::stop;
  rig.execution.causes = 1U << static_cast<unsigned>(Cause::drive_not_enabled);
  const auto epoch = rig.go.epoch;
  rig.run(1.0);
  EXPECT_EQ(rig.go.epoch, epoch) << "not by itself";
  TaskGoal acknowledge;
  acknowledge.id = 9;
  acknowledge.kind = TaskKind::acknowledge;
  rig.supervisor.on(acknowledge, rig.now);
  rig.run(0.12);
  EXPECT_EQ(rig.go.epoch, epoch + 1);
  EXPECT_TRUE(rig.go.acknowledge);
  rig.execution.mode = Mode::hold;
  rig.execution.causes = 1U << static_cast<unsigned>(Cause::no_go);
  rig.run(0.3);
  EXPECT_EQ(rig.go.epoch, epoch + 2);
  EXPECT_FALSE(rig.go.acknowledge);
}

TEST(Permission, NoNewEpochWhileACauseStands) {
  Rig rig;
  rig.run(0.5);
  rig.execution.mode = Mode::stop;
  rig.execution.causes = 1U << static_cast<unsigned>(Cause::human_state_silent);
  const auto epoch = rig.go.epoch;
  rig.run(1.0);
  EXPECT_EQ(rig.go.epoch, epoch);
  rig.execution.causes = 0;
  rig.run(0.3);
  EXPECT_GT(rig.go.epoch, epoch);
}

}  // namespace
}  // namespace handsel::supervisor
