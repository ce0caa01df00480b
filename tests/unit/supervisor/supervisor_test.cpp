// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/support/task_rig.hpp"

namespace handsel::supervisor::supervisor_test {
namespace {

TEST(Supervisor, gives_a_mug_in_three_actions_one_after_the_other) {
  TaskRig rig(true);
  rig.run(0.5);
  EXPECT_TRUE(rig.go.allowed);
  rig.give(1);
  rig.run(0.1);
  ASSERT_EQ(rig.goals.size(), 1u);
  EXPECT_EQ(rig.goals[0].kind, ActionKind::pick);
  EXPECT_EQ(rig.line("pick mug for anna"), "running");
  EXPECT_GT(rig.last().cost, 10);
  rig.end_action(ActionState::succeeded);
  ASSERT_EQ(rig.goals.size(), 2u);
  EXPECT_EQ(rig.goals[1].kind, ActionKind::give);
  EXPECT_EQ(rig.goals[1].human, "anna");
  EXPECT_EQ(rig.line("pick mug for anna"), "done");
  rig.end_action(ActionState::succeeded);
  ASSERT_EQ(rig.goals.size(), 3u);
  EXPECT_EQ(rig.goals[2].kind, ActionKind::go_to);
  rig.end_action(ActionState::succeeded);
  EXPECT_EQ(rig.last().state, TaskState::succeeded);
  EXPECT_EQ(rig.last().plan.size(), 3u);
  EXPECT_EQ(rig.last().cost, 0);
}

TEST(Supervisor, facts_may_lag_behind_an_action_that_succeeded) {
  TaskRig rig(true);
  rig.run(0.5);
  rig.give(1);
  rig.run(0.1);
  rig.action.state = ActionState::succeeded;  // without an effect in the world
  rig.run(0.1);
  ASSERT_EQ(rig.goals.size(), 2u);
  EXPECT_EQ(rig.goals[1].kind, ActionKind::give);
}

TEST(Supervisor, a_gift_for_nobody_in_particular_waits_for_somebody_and_is_picked_for_them) {
  TaskRig rig(true);
  rig.world.people.clear();
  rig.run(0.5);
  rig.give(1, "");
  rig.run(1.0);
  EXPECT_TRUE(rig.goals.empty());
  EXPECT_EQ(rig.last().phase, "looking for somebody");
  rig.world.people["bert"] = true;
  rig.run(0.1);
  ASSERT_EQ(rig.goals.size(), 1u);
  EXPECT_EQ(rig.goals[0].kind, ActionKind::pick);
  EXPECT_EQ(rig.goals[0].human, "bert");
  EXPECT_EQ(rig.last().plan[1], "give mug to bert");
}

TEST(Supervisor, when_nobody_comes_the_gift_fails_before_anything_moves) {
  TaskRig rig;
  rig.world.people.clear();
  rig.run(0.5);
  rig.give(1, "");
  rig.run(2.2);
  EXPECT_TRUE(rig.goals.empty());
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_NE(rig.last().reason.find("nobody is in sight"), std::string::npos) << rig.last().reason;
}

TEST(Supervisor, who_is_out_of_sight_for_a_moment_is_waited_for_who_was_never_there_is_not) {
  TaskRig rig;
  rig.run(3.0);
  rig.world.people.clear();
  rig.give(1);
  rig.run(0.5);
  EXPECT_EQ(rig.last().phase, "looking for anna");
  rig.world.people["anna"] = true;
  EXPECT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  rig.give(2, "carl");
  rig.run(0.04);
  EXPECT_EQ(rig.last().state, TaskState::refused);
}

TEST(Supervisor, an_untaken_object_is_offered_once_more_then_put_back) {
  TaskRig rig;
  rig.fails = [](const ActionGoal& goal) {
    if (goal.kind != ActionKind::give) return Failure();
    return Failure("anna did not take mug within 15 s", ActionFailure::not_taken);
  };
  rig.run(0.5);
  rig.give(1);
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.done(),
            "pick mug for anna, give mug to anna, give mug to anna, place mug on table, "
            "go to rest");
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_EQ(rig.last().reason, "give mug to anna: anna did not take mug within 15 s");
  EXPECT_EQ(rig.line("give mug to anna"), "failed: anna did not take mug within 15 s");
  EXPECT_EQ(rig.last().tree.front().text, "give mug to anna");
  EXPECT_EQ(rig.last().tree.front().state, StepState::failed);
}

TEST(Supervisor, what_finds_no_place_is_handed_to_a_person_and_the_reason_says_so) {
  TaskRig rig;
  rig.world.people["bert"] = false;
  rig.fails = [](const ActionGoal& goal) {
    if (goal.kind == ActionKind::place) return Failure("no free place");
    const bool to_anna = goal.human == "anna" && goal.kind == ActionKind::give;
    return to_anna ? Failure("anna did not take mug", ActionFailure::not_taken) : Failure();
  };
  rig.run(0.5);
  rig.give(1);
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_EQ(rig.last().reason, "give mug to anna: anna did not take mug; mug was handed to bert");
  EXPECT_NE(rig.done().find("place mug on table"), std::string::npos) << rig.done();
  EXPECT_NE(rig.done().find("give mug to bert, go to rest"), std::string::npos) << rig.done();
}

TEST(Supervisor, when_nobody_is_named_another_person_is_asked) {
  TaskRig rig;
  rig.world.people["bert"] = false;
  rig.fails = [](const ActionGoal& goal) {
    const bool to_anna = goal.human == "anna" && goal.kind == ActionKind::give;
    return to_anna ? Failure("anna did not take mug", ActionFailure::not_taken) : Failure();
  };
  rig.run(0.5);
  rig.give(1, "");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.done(),
            "pick mug for anna, give mug to anna, give mug to anna, give mug to bert, go to rest");
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  EXPECT_EQ(rig.line("give mug to anna"), "failed: anna did not take mug");
}

TEST(Supervisor, a_failure_is_answered_by_its_kind) {
  TaskRig rig;
  int picks = 0;
  rig.fails = [&](const ActionGoal& goal) {
    const bool empty = goal.kind == ActionKind::pick && ++picks < 3;
    if (!empty) return Failure();
    return Failure("nothing is between the fingers", ActionFailure::nothing_grasped);
  };
  rig.run(0.5);
  rig.ask(TaskKind::pick, "mug");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  EXPECT_EQ(picks, 3);

  TaskRig other;
  other.fails = [&](const ActionGoal& goal) {
    return goal.kind == ActionKind::pick ? "no grasp for mug: none is left" : "";
  };
  other.run(0.5);
  other.ask(TaskKind::pick, "mug");
  ASSERT_TRUE(other.finish());
  EXPECT_EQ(other.done(), "pick mug, go to rest");
  EXPECT_EQ(other.last().state, TaskState::failed);
  EXPECT_EQ(other.last().reason, "pick mug: no grasp for mug: none is left");
}

TEST(Supervisor, clears_a_table_while_somebody_takes_one_thing_away) {
  TaskRig rig;
  rig.world.on.clear();
  for (const char* object : {"a", "b", "c", "d", "e", "f"}) rig.world.on[object] = "table";
  rig.run(2.5);
  rig.ask(TaskKind::clear, "", "", "table");
  rig.run(0.3);
  ASSERT_EQ(rig.done(), "pick a");
  const std::uint64_t running = rig.goals.back().id;
  rig.world.on.erase("d");
  rig.world.held_by["d"] = "anna";
  rig.action_time = 2.0;
  rig.run(1.0);
  EXPECT_EQ(rig.goals.back().id, running) << "the running action goes on";
  EXPECT_EQ(rig.line("pick d"), "dropped: anna took d");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  EXPECT_EQ(rig.last().reason, "anna took d");
  EXPECT_EQ(rig.done(),
            "pick a, place a on shelf, pick b, place b on shelf, pick c, place c on shelf, pick e, "
            "place e on shelf, pick f, "
            "place f on shelf, go to rest");
  for (const auto& [object, surface] : rig.world.on) EXPECT_EQ(surface, "shelf") << object;
}

TEST(Supervisor, what_is_taken_while_the_robot_reaches_for_it_is_let_be) {
  TaskRig rig;
  rig.world.on["box"] = "table";
  rig.action_time = 3.0;
  rig.run(2.5);
  rig.ask(TaskKind::clear, "", "", "table");
  rig.run(0.5);
  ASSERT_EQ(rig.done(), "pick box");
  rig.world.on.erase("box");
  rig.world.held_by["box"] = "anna";
  rig.run(1.0);
  EXPECT_EQ(rig.done(), "pick box, pick mug");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded);
  EXPECT_EQ(rig.last().reason, "anna took box");
}

TEST(Supervisor, waits_for_a_person_who_has_the_only_object_of_the_task) {
  for (const bool comes_back : {true, false}) {
    SCOPED_TRACE(comes_back);
    TaskRig rig;
    rig.action_time = 6.0;
    rig.run(2.5);
    rig.ask(TaskKind::pick, "mug");
    rig.run(0.5);
    ASSERT_EQ(rig.done(), "pick mug");
    rig.world.on.erase("mug");
    rig.world.held_by["mug"] = "anna";
    rig.run(3.0);
    EXPECT_EQ(rig.done(), "pick mug") << "the person may put it down again";
    if (comes_back) {
      rig.world.held_by.erase("mug");
      rig.world.on["mug"] = "shelf";
    } else {
      rig.action_time = 14.0;
    }
    ASSERT_TRUE(rig.finish());
    EXPECT_EQ(rig.last().state, comes_back ? TaskState::succeeded : TaskState::failed)
        << rig.last().reason;
  }
}

TEST(Supervisor, what_comes_onto_the_table_meanwhile_is_cleared_too) {
  TaskRig rig;
  rig.run(2.5);
  rig.ask(TaskKind::clear, "", "", "table");
  rig.run(0.5);
  rig.world.on["cup"] = "table";
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  EXPECT_EQ(rig.world.on["cup"], "shelf");
}

TEST(Supervisor, what_cannot_be_grasped_is_left_and_told) {
  TaskRig rig;
  rig.world.on["box"] = "table";
  rig.fails = [](const ActionGoal& goal) {
    return goal.object == "box" ? "no grasp for box: too wide" : "";
  };
  rig.run(2.5);
  rig.ask(TaskKind::clear, "", "", "table");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.world.on["mug"], "shelf");
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_EQ(rig.last().reason,
            "not all of it was done: clear box away: no grasp for box: too wide");
}

TEST(Supervisor, what_cannot_be_put_away_goes_back_and_the_rest_is_cleared) {
  TaskRig rig;
  rig.world.on["box"] = "table";
  rig.fails = [](const ActionGoal& goal) {
    return goal.kind == ActionKind::place && goal.object == "box" && goal.surface == "shelf"
               ? "no free place on shelf"
               : "";
  };
  rig.run(2.5);
  rig.ask(TaskKind::clear, "", "", "table");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(
      rig.done(),
      "pick box, place box on shelf, place box on table, pick mug, place mug on shelf, go to rest");
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_EQ(rig.last().reason, "not all of it was done: clear box away: no free place on shelf");
}

TEST(Supervisor, a_table_is_not_clear_while_its_last_thing_is_in_the_hand) {
  TaskRig rig;
  int failures = 0;
  rig.fails = [&](const ActionGoal& goal) {
    return goal.kind == ActionKind::place && goal.surface == "shelf" && failures++ == 0
               ? "no free place on shelf"
               : "";
  };
  rig.run(2.5);
  rig.ask(TaskKind::clear, "", "", "table");
  ASSERT_TRUE(rig.finish());
  EXPECT_TRUE(rig.world.in_hand().empty());
  EXPECT_EQ(rig.last().state == TaskState::succeeded, rig.world.on["mug"] == "shelf")
      << rig.last().reason;
}

TEST(Supervisor, receives_and_puts_down_whatever_it_is) {
  TaskRig rig;
  rig.world.on.clear();
  rig.world.held_by["cup"] = "anna";
  rig.run(2.5);
  rig.ask(TaskKind::receive, "", "anna", "shelf");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  EXPECT_EQ(rig.world.on["cup"], "shelf");

  rig.world.people["bert"] = true;
  rig.run(0.1);
  rig.action_time = 1.0;
  rig.ask(TaskKind::receive, "", "bert");
  rig.run(0.5);
  rig.world.held_by["ball"] = "bert";  // arrives with an unobserved object
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  EXPECT_TRUE(rig.world.on.contains("ball"));
}

TEST(Supervisor, what_cannot_be_put_down_as_it_was_taken_is_handed_back_and_taken_anew_once) {
  for (const bool serves_at_last : {true, false}) {
    for (const std::string from : {"anna", ""}) {
      TaskRig rig;
      rig.world.on.clear();
      rig.world.held_by["mug"] = "anna";
      int takes = 0;
      rig.fails = [&](const ActionGoal& goal) {
        takes += goal.kind == ActionKind::receive;
        const bool serves = takes > 1 && serves_at_last;
        return Failure(goal.kind == ActionKind::place && !serves ? "no free place" : "");
      };
      rig.run(2.5);
      rig.ask(TaskKind::receive, "mug", from, "table");
      ASSERT_TRUE(rig.finish());
      EXPECT_EQ(takes, 2);
      if (serves_at_last) {
        EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
        EXPECT_EQ(rig.done(),
                  "receive mug from anna, place mug on table, give mug to anna, "
                  "receive mug from anna, place mug on table, go to rest");
      } else {
        EXPECT_EQ(rig.last().state, TaskState::failed);
        EXPECT_EQ(rig.last().reason, "place mug on table: no free place; mug was handed to anna");
      }
    }
  }
}

TEST(Supervisor, what_cannot_be_passed_on_as_it_is_taken_is_handed_back_and_passed_on_then) {
  Ability two;  // the table is at x = 5 m, in reach of the second arm only
  two.hands = 2;
  two.arms = {{"hand", {0, 0, 1}, 1.2}, {"left_hand", {5, 0, 1}, 1.2}};
  TaskRig rig(false, two);
  rig.world.on.clear();
  rig.world.held_by["mug"] = "anna";
  int takes = 0;
  rig.fails = [&](const ActionGoal& goal) {
    takes += goal.kind == ActionKind::receive;
    return Failure(goal.kind == ActionKind::regrasp && takes == 1 ? "the hands do not meet" : "");
  };
  rig.run(2.5);
  rig.ask(TaskKind::receive, "mug", "anna", "table");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  EXPECT_EQ(rig.done(),
            "receive mug from anna, regrasp mug on table, give mug to anna, "
            "receive mug from anna, regrasp mug on table, go to rest");
}

TEST(Supervisor, what_has_no_place_once_it_is_taken_is_handed_back_at_most_twice) {
  TaskRig rig;
  rig.world.on.clear();
  rig.world.held_by["mug"] = "anna";
  const auto surfaces = rig.world.surfaces;
  int takes = 0;
  rig.fails = [&](const ActionGoal& goal) {
    takes += goal.kind == ActionKind::receive;
    if (goal.kind == ActionKind::receive) rig.world.surfaces.clear();
    if (goal.kind == ActionKind::give) rig.world.surfaces = surfaces;
    return Failure();
  };
  rig.run(2.5);
  rig.ask(TaskKind::receive, "mug", "anna", "table");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(takes, 2);
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_EQ(rig.last().reason, "mug was handed back twice: it cannot be put down as it is taken");
}

TEST(Supervisor, what_is_so_already_is_done_with_a_sentence) {
  TaskRig rig;
  rig.run(2.5);
  rig.ask(TaskKind::place, "mug", "", "table");
  rig.run(0.1);
  EXPECT_EQ(rig.last().state, TaskState::succeeded);
  EXPECT_EQ(rig.last().reason, "mug is on table already");
  EXPECT_TRUE(rig.goals.empty());
}

TEST(Supervisor, what_is_not_there_is_refused_at_once_but_sight_is_given_a_moment_after_the_start) {
  TaskRig rig;
  rig.world.on.clear();
  rig.run(0.5);
  rig.give(1);
  rig.run(0.5);
  EXPECT_TRUE(rig.statuses.empty());
  rig.world.on["mug"] = "table";
  rig.run(0.5);
  EXPECT_EQ(rig.last().state, TaskState::running);
  ASSERT_TRUE(rig.finish());
  rig.run(2.0);
  rig.ask(TaskKind::pick, "cup");
  rig.run(0.04);
  EXPECT_EQ(rig.last().state, TaskState::refused);
  EXPECT_NE(rig.last().reason.find("nothing called cup here; there is mug"), std::string::npos)
      << rig.last().reason;
}

TEST(Supervisor, an_action_goal_is_repeated_until_taken_up) {
  TaskRig rig(true);
  rig.planner_alive = false;
  rig.run(0.5);
  rig.give(1);
  rig.run(1.2);
  ASSERT_GE(rig.goals.size(), 2u);
  EXPECT_EQ(rig.goals.front().id, rig.goals.back().id);
}

TEST(Supervisor, a_planner_that_was_started_anew_is_told_again) {
  TaskRig rig;
  rig.run(0.5);
  rig.give(1);
  rig.run(0.5);
  rig.action = {};
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
}

TEST(Supervisor, a_supervisor_that_was_started_anew_goes_on_when_asked_again) {
  TaskRig before(true), after;
  before.run(0.5);
  before.give(1);
  before.run(0.2);
  before.end_action(ActionState::succeeded);
  ASSERT_EQ(before.done(), "pick mug for anna, give mug to anna");
  after.world = before.world;
  after.action = before.action;
  after.run(0.2);
  after.give(1);
  after.run(0.1);
  EXPECT_TRUE(after.goals.empty()) << "the running action is taken over";
  EXPECT_EQ(after.line("give mug to anna"), "running");
  after.world.perform(ActionKind::give, "mug", "anna", "");
  after.action.state = ActionState::succeeded;
  ASSERT_TRUE(after.finish());
  EXPECT_EQ(after.last().state, TaskState::succeeded) << after.last().reason;
  EXPECT_EQ(after.done(), "go to rest");
}

TEST(Supervisor, a_task_nobody_asks_for_again_after_a_restart_is_declared_over) {
  TaskRig rig(true);
  rig.action.id = 7;
  rig.action.task = 9;
  rig.action.state = ActionState::running;
  rig.run(6.0);
  ASSERT_FALSE(rig.statuses.empty());
  EXPECT_EQ(rig.last().id, 9u);
  EXPECT_EQ(rig.last().state, TaskState::failed);
}

TEST(Supervisor, the_same_goal_twice_is_one_task_and_another_is_refused_while_busy) {
  TaskRig rig(true);
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

TEST(Supervisor, cancel_stops_the_action_and_ends_the_task) {
  TaskRig rig(true);
  rig.run(0.5);
  rig.give(1);
  rig.run(0.1);
  rig.ask(TaskKind::cancel);
  rig.run(0.1);
  EXPECT_TRUE(rig.goals.back().cancel);
  bool cancelled = false;
  for (const auto& status : rig.statuses)
    cancelled |= status.id == 1 && status.state == TaskState::cancelled;
  EXPECT_TRUE(cancelled);
}

TEST(Supervisor, paused_nothing_is_begun_and_it_goes_on_where_it_was) {
  TaskRig rig;
  rig.run(0.5);
  rig.give(1);
  rig.run(0.5);
  rig.ask(TaskKind::pause);
  rig.run(3.0);
  EXPECT_EQ(rig.done(), "pick mug for anna");
  EXPECT_EQ(rig.last().state, TaskState::paused);
  rig.ask(TaskKind::resume);
  rig.run(0.1);
  ASSERT_TRUE(rig.finish());
  rig.run(1.0);
  ASSERT_TRUE(rig.finish());
}

TEST(Supervisor, attention_may_suspend_resume_and_turn_a_task_into_a_gift) {
  TaskRig rig;
  rig.run(2.5);
  rig.ask(TaskKind::place, "mug", "", "shelf");
  rig.run(1.3);
  ASSERT_EQ(rig.done(), "pick mug, place mug on shelf");
  rig.advise(TaskChange::suspend);
  rig.run(0.1);
  EXPECT_EQ(rig.last().state, TaskState::paused);
  EXPECT_FALSE(rig.go.allowed);
  rig.advise(TaskChange::resume);
  rig.run(0.3);
  EXPECT_TRUE(rig.go.allowed);
  rig.advise(TaskChange::give, "anna");
  ASSERT_TRUE(rig.finish());
  EXPECT_EQ(rig.world.held_by["mug"], "anna");
  EXPECT_EQ(rig.last().state, TaskState::succeeded) << rig.last().reason;
  EXPECT_EQ(rig.line("place mug on shelf"), "dropped: anna reaches for mug");
}

TEST(Supervisor, a_component_that_stays_away_ends_the_task_with_its_name) {
  TaskRig rig(true);
  rig.run(0.5);
  rig.give(1);
  rig.run(0.1);
  ASSERT_EQ(rig.goals.size(), 1u);
  rig.spark_alive = false;
  rig.run(3.0);
  rig.end_action(ActionState::succeeded);
  EXPECT_EQ(rig.goals.size(), 1u) << "nothing new begins without it";
  EXPECT_EQ(rig.last().state, TaskState::running);
  rig.run(2.5);
  EXPECT_EQ(rig.last().state, TaskState::failed);
  EXPECT_EQ(rig.last().reason, "spark has not been there for 5 s");
  rig.spark_alive = true;
  rig.run(1.0);
  rig.give(2);
  rig.run(0.2);
  EXPECT_EQ(rig.last().state, TaskState::running) << "the next task goes on";
}

TEST(Permission,
     is_withdrawn_when_a_required_component_is_gone_but_only_after_the_trajectory_ended) {
  TaskRig rig(true);
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

TEST(Permission, after_a_fault_only_a_person_resumes) {
  TaskRig rig(true);
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

TEST(Permission, a_persons_word_reaches_a_drive_that_waits_for_it_and_permission_comes_after) {
  TaskRig rig(true);
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
  EXPECT_FALSE(rig.go.allowed) << "only after the resume delay";
  rig.execution.mode = Mode::hold;
  rig.execution.causes = 1U << static_cast<unsigned>(Cause::no_go);
  rig.run(0.3);
  EXPECT_EQ(rig.go.epoch, epoch + 2);
  EXPECT_TRUE(rig.go.allowed);
  EXPECT_FALSE(rig.go.acknowledge);
}

TEST(Permission, no_new_epoch_while_a_cause_stands) {
  TaskRig rig(true);
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
}  // namespace handsel::supervisor::supervisor_test
