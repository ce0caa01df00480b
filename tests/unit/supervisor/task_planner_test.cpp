// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "common/model/human/human_body.hpp"
#include "components/supervisor/task/task_planner.hpp"
#include "tests/support/task_world.hpp"

namespace handsel::supervisor::task_planner_test {
namespace {

const Domain& shipped() {
  static const Domain domain = load_domain(resource("config/tasks.txtpb"));
  return domain;
}

struct Asked {
  TaskQuery query;
  Plan plan;
  std::string reason() const {
    return !query.reason.empty() ? query.reason : plan.found ? left_out(plan) : plan.reason;
  }
  std::string steps() const {
    std::string out;
    for (const auto& action : plan.actions) out += (out.empty() ? "" : ", ") + action.text();
    return out;
  }
};

TaskGoal goal(TaskKind kind, const std::string& object, const std::string& human = "",
              const std::string& surface = "", const std::string& onto = "") {
  return {
      .id = 1, .kind = kind, .object = object, .human = human, .surface = surface, .onto = onto};
}

Asked ask(const TaskGoal& wanted, const TaskWorld& here, const Forbidden& forbidden = {},
          const Ability& ability = {}, const HumanState& people = {}) {
  const World world = make_world(here.facts(), here.scene(), ability, people);
  Asked out{query_for(wanted, shipped(), world, here.scene()), {}};
  if (out.query.reason.empty())
    out.plan = make_plan(shipped(), world, out.query.task, out.query.args, forbidden, {4000, 24});
  return out;
}

TaskWorld mug_on_table() {
  TaskWorld world;
  world.on["mug"] = "table";
  world.people = {{"anna", true}, {"bert", false}};
  return world;
}

TEST(TaskPlanner, gives_picks_places_and_goes) {
  TaskWorld world = mug_on_table();
  EXPECT_EQ(ask(goal(TaskKind::give, "mug", "bert"), world).steps(),
            "pick mug for bert, give mug to bert, go to rest");
  EXPECT_EQ(ask(goal(TaskKind::pick, "mug"), world).steps(), "pick mug");
  EXPECT_EQ(ask(goal(TaskKind::place, "mug", "", "shelf"), world).steps(),
            "pick mug, place mug on shelf, go to rest");
  EXPECT_EQ(ask(goal(TaskKind::go_to, "", "", "rest"), world).steps(), "go to rest");
  world.on.clear();
  world.held_by["mug"] = kRobotName;
  EXPECT_EQ(ask(goal(TaskKind::give, "mug", "anna"), world).steps(),
            "give mug to anna, go to rest");
  EXPECT_EQ(ask(goal(TaskKind::pick, "mug"), world).steps(), "");
}

/// A robot at the origin whose arm reaches 1 m, and Anna at `place` [m].
struct Driving {
  explicit Driving(const Vector3& place) {
    ability.drives = true;
    ability.arms = {{"hand", Vector3::Zero(), 1.0}};
    ability.person_reach = 0.5;
    Person anna;
    anna.id = "anna";
    anna.joints = standing_body(place, 0, 1.75);
    people.people = {anna};
  }
  Ability ability;
  HumanState people;
};

TEST(TaskPlanner, a_robot_that_drives_goes_to_what_is_out_of_reach_and_only_then) {
  TaskWorld world;
  world.on["mug"] = "table";
  world.people = {{"anna", true}};
  world.distance["mug"] = 2;
  const Driving far({4, 0, 0}), near({0.3, 0, -1.2});
  const auto steps = [&](TaskGoal wanted, const Driving& robot) {
    return ask(wanted, world, {}, robot.ability, robot.people).steps();
  };
  EXPECT_EQ(steps(goal(TaskKind::give, "mug", "anna"), far),
            "drive to mug, pick mug for anna, drive to anna, give mug to anna, go to rest");
  world.distance["mug"] = 0.5;
  EXPECT_EQ(steps(goal(TaskKind::give, "mug", "anna"), near),
            "pick mug for anna, give mug to anna, go to rest");
  world.on["mug"] = "shelf";
  EXPECT_EQ(steps(goal(TaskKind::place, "mug", "", "table"), near),
            "pick mug, drive to table, place mug on table, go to rest");
  EXPECT_EQ(steps(goal(TaskKind::drive, "", "anna"), near), "drive to anna");
  EXPECT_EQ(steps(goal(TaskKind::drive, ""), near), "drive to the place");
}

TEST(TaskPlanner, a_robot_that_stands_says_that_it_does_not_drive) {
  const TaskWorld world = mug_on_table();
  EXPECT_EQ(ask(goal(TaskKind::drive, "", "anna"), world).reason(),
            "the robot does not drive: its description has no platform that does");
}

TEST(TaskPlanner, of_people_an_attentive_one_is_cheapest_and_who_refused_is_not_asked_again) {
  const TaskWorld world = mug_on_table();
  EXPECT_EQ(ask(goal(TaskKind::give, "mug"), world).steps(),
            "pick mug for anna, give mug to anna, go to rest");
  const Forbidden refused{{"give mug to anna", "anna did not take mug"}};
  EXPECT_EQ(ask(goal(TaskKind::give, "mug"), world, refused).steps(),
            "pick mug for bert, give mug to bert, go to rest");
  EXPECT_EQ(ask(goal(TaskKind::give, "mug", "anna"), world, refused).reason(),
            "anna did not take mug")
      << "who is named is meant";
}

TEST(TaskPlanner, receives_what_is_offered_or_whatever_comes) {
  TaskWorld world;
  world.held_by["mug"] = "anna";
  world.people = {{"anna", true}, {"bert", true}};
  world.offering = {"anna"};
  const std::string taken = "receive mug from anna, place mug on shelf, go to rest";
  EXPECT_EQ(ask(goal(TaskKind::receive, "mug", "anna", "", "shelf"), world).steps(), taken);
  EXPECT_EQ(ask(goal(TaskKind::receive, "", "anna", "", "shelf"), world).steps(), taken);
  EXPECT_EQ(ask(goal(TaskKind::receive, "mug", "", "", "shelf"), world).steps(), taken);
  EXPECT_EQ(ask(goal(TaskKind::receive, "", "", "", "shelf"), world).steps(), taken);
  EXPECT_EQ(ask(goal(TaskKind::receive, "", "bert", "", "shelf"), world).steps(),
            "receive something from bert, place something on shelf, go to rest");
}

TEST(TaskPlanner, clears_a_table_of_six_nearest_first_as_a_tree) {
  TaskWorld world;
  for (int i = 0; i < 6; ++i) {
    const std::string object(1, static_cast<char>('f' - i));
    world.on[object] = "table";
    world.distance[object] = 0.4 + 0.05 * i;
  }
  const Asked cleared = ask(goal(TaskKind::clear, "", "", "table"), world);
  ASSERT_TRUE(cleared.plan.found) << cleared.reason();
  EXPECT_EQ(cleared.steps().substr(0, 51), "pick f, place f on shelf, pick e, place e on shelf,");
  EXPECT_EQ(cleared.plan.actions.size(), 13u);
  EXPECT_TRUE(cleared.plan.proven);
  EXPECT_LT(cleared.plan.nodes, 200u);
  ASSERT_GT(cleared.plan.tree.size(), 5u);
  EXPECT_EQ(cleared.plan.tree[0].text, "clear table");
  EXPECT_EQ(cleared.plan.tree[1].text, "clear f away");
  EXPECT_EQ(cleared.plan.tree[1].depth, 1u);
  EXPECT_EQ(cleared.plan.tree[2].text, "bring f to shelf");
  EXPECT_EQ(cleared.plan.tree[3].text, "fetch f");
}

TEST(TaskPlanner, what_is_out_of_reach_is_left_where_it_is_and_told) {
  TaskWorld world;
  world.on = {{"box", "table"}, {"mug", "table"}};
  world.distance["box"] = 1.4;
  const Asked cleared = ask(goal(TaskKind::clear, "", "", "table"), world);
  EXPECT_EQ(cleared.steps(), "pick mug, place mug on shelf, go to rest");
  EXPECT_EQ(cleared.reason(),
            "clear box away: box is out of the robot's reach; bring it nearer to the robot");
}

TEST(TaskPlanner, room_counts_what_is_put_there) {
  TaskWorld world;
  world.surfaces = {
      {"table", {0.7, 0.7, 0.7}}, {"stool", {0.2, 0.2, 0.5}}, {"tray", {0.2, 0.4, 0.5}}};
  for (const char* object : {"a", "b", "c"}) world.on[object] = "table";
  const Asked cleared = ask(goal(TaskKind::clear, "", "", "table"), world);
  std::map<std::string, int> on;
  for (const auto& action : cleared.plan.actions)
    if (action.kind == ActionKind::place) ++on[action.surface];
  EXPECT_EQ(on["stool"], 1) << cleared.steps();
  EXPECT_EQ(on["tray"], 2) << cleared.steps();
}

TEST(TaskPlanner, tidies_all_of_a_kind) {
  TaskWorld world;
  world.on = {{"cup1", "table"}, {"cup2", "table"}, {"box", "table"}, {"cup3", "shelf"}};
  world.models = {{"cup1", "cup"}, {"cup2", "cup"}, {"cup3", "cup"}};
  EXPECT_EQ(ask(goal(TaskKind::tidy, "cup", "", "", "shelf"), world).steps(),
            "pick cup1, place cup1 on shelf, pick cup2, place cup2 on shelf, go to rest");
  EXPECT_EQ(ask(goal(TaskKind::tidy, "box", "", "", "shelf"), world).steps(),
            "pick box, place box on shelf, go to rest");
}

TEST(TaskPlanner, a_full_hand_is_freed_first) {
  TaskWorld world = mug_on_table();
  world.held_by["box"] = kRobotName;
  const Asked given = ask(goal(TaskKind::give, "mug", "anna"), world);
  EXPECT_EQ(given.plan.actions.size(), 4u) << given.steps();
  EXPECT_EQ(given.plan.actions[0].text().substr(0, 12), "place box on");
}

TEST(TaskPlanner, what_somebody_else_has_is_asked_for) {
  TaskWorld world = mug_on_table();
  world.on.clear();
  world.held_by["mug"] = "bert";
  EXPECT_EQ(ask(goal(TaskKind::give, "mug", "anna"), world).steps(),
            "receive mug from bert, give mug to anna, go to rest");
}

TEST(TaskPlanner, refuses_at_once_with_what_would_make_it_possible) {
  TaskWorld world = mug_on_table();
  const auto says = [&](const TaskGoal& wanted, const std::string& part,
                        const Ability& ability = {}) {
    const std::string reason = ask(wanted, world, {}, ability).reason();
    EXPECT_NE(reason.find(part), std::string::npos)
        << "\"" << reason << "\" lacks \"" << part << "\"";
  };
  says(goal(TaskKind::give, "cup", "anna"), "there is nothing called cup here; there is mug");
  says(goal(TaskKind::give, "mug", "carl"),
       "nobody called carl is in sight; in sight is anna, bert");
  says(goal(TaskKind::place, "mug", "", "floor"),
       "floor is no surface here; there is shelf, table");
  says(goal(TaskKind::place, "mug", "", "wall"), "wall is no surface to put things on");
  says(goal(TaskKind::clear, "", "", "table", "table"), "cannot be cleared onto itself");
  says(goal(TaskKind::tidy, "glass", "", "", "shelf"), "there is nothing called glass");
  says(goal(TaskKind::go_to, "", "", "the moon"), "no configuration called the moon");
  says(goal(TaskKind::give, ""), "needs the name of an object");
  says(goal(TaskKind::regrasp, "mug"), "needs two hands");
  world.distance["mug"] = 1.5;
  says(goal(TaskKind::give, "mug", "anna"), "mug is out of the robot's reach; bring it nearer");
  world.distance.clear();
  world.surfaces.erase("shelf");
  says(goal(TaskKind::clear, "", "", "table"), "no other surface with room");

  ObjectModel heavy;
  heavy.mass = 5;
  Ability weak;
  weak.payload = 3;
  weak.objects = [&](const std::string&) { return &heavy; };
  says(goal(TaskKind::place, "mug", "", "table"), "");
  says(goal(TaskKind::pick, "mug"), "mug is too heavy for one hand", weak);
  world.surfaces["shelf"] = {0.7, 0.7, 0.7};
  weak.hands = 2;
  EXPECT_EQ(ask(goal(TaskKind::place, "mug", "", "shelf"), world, {}, weak).steps(),
            "carry mug on shelf, go to rest");
  heavy.mass = 7;
  says(goal(TaskKind::place, "mug", "", "shelf"), "mug is too heavy for the robot", weak);
}

/// A box of this width, an object of the mass that both hands of the robot bear, but not one.
struct Burden {
  Burden(double mass, double width) {
    object.mass = mass;
    object.mesh.vertices = {{-width / 2, -0.05, 0}, {width / 2, 0.05, 0.1}};
    robot.payload = 3;
    robot.max_width = 0.5;
    robot.hands = 2;
    robot.objects = [this](const std::string&) { return &object; };
  }
  ObjectModel object;
  Ability robot;
};

TEST(TaskPlanner, what_is_too_heavy_or_too_wide_for_one_hand_is_given_with_both) {
  const TaskWorld world = mug_on_table();
  const TaskGoal give = goal(TaskKind::give, "mug", "anna");
  const std::string with_both = "give mug to anna with both hands, go to rest";
  const Burden heavy(5, 0.1), wide(1, 0.6), light(1, 0.4);
  EXPECT_EQ(ask(give, world, {}, heavy.robot).steps(), with_both);
  EXPECT_EQ(ask(give, world, {}, wide.robot).steps(), with_both);
  EXPECT_EQ(ask(give, world, {}, light.robot).steps(),
            "pick mug for anna, give mug to anna, go to rest");
  const auto& actions = ask(give, world, {}, wide.robot).plan.actions;
  ASSERT_FALSE(actions.empty());
  EXPECT_TRUE(actions.front().both_hands);
}

TEST(TaskPlanner, a_give_with_both_hands_is_refused_with_the_reason) {
  TaskWorld world = mug_on_table();
  const TaskGoal give = goal(TaskKind::give, "mug", "anna");
  const auto reason = [&](const Burden& burden) {
    return ask(give, world, {}, burden.robot).reason();
  };
  Burden heavy(5, 0.1), wide(1, 0.6);
  heavy.robot.hands = wide.robot.hands = 1;
  EXPECT_THAT(reason(heavy), testing::HasSubstr("the robot has no other"));
  EXPECT_EQ(ask(give, world, {}, wide.robot).steps(),
            "pick mug for anna, give mug to anna, go to rest");
  EXPECT_THAT(reason(Burden(7, 0.1)), testing::HasSubstr("mug is too heavy for the robot"));
  world.distance["mug"] = 1.5;
  EXPECT_THAT(reason(Burden(1, 0.6)), testing::HasSubstr("out of the robot's reach"));
}

TEST(TaskPlanner, hands_that_hold_something_put_it_down_before_they_give_with_both) {
  TaskWorld world = mug_on_table();
  world.held_by["cup"] = kRobotName;
  const Burden burden(5, 0.1);
  Ability robot = burden.robot;
  robot.objects = [&](const std::string& model) {
    return model == "mug" ? &burden.object : nullptr;
  };
  const std::string steps = ask(goal(TaskKind::give, "mug", "anna"), world, {}, robot).steps();
  EXPECT_THAT(steps, testing::StartsWith("place cup on "));
  EXPECT_THAT(steps, testing::EndsWith("give mug to anna with both hands, go to rest"));
}

TEST(TaskPlanner, an_object_changes_hands_where_one_arm_does_not_reach_both_places) {
  TaskWorld world = mug_on_table();  // the shelf is at x = 0 m, the table at x = 5 m
  Ability two;
  two.hands = 2;
  two.arms = {{"hand", {0, 0, 1}, 1.2}, {"left_hand", {5, 0, 1}, 1.2}};
  const TaskGoal to_shelf = goal(TaskKind::place, "mug", "", "shelf");
  EXPECT_EQ(ask(to_shelf, world, {}, two).steps(), "regrasp mug on shelf, go to rest");
  world.on.clear();
  world.held_by["mug"] = kRobotName;  // held by the first hand
  EXPECT_EQ(ask(to_shelf, world, {}, two).steps(), "place mug on shelf, go to rest");
  EXPECT_EQ(ask(goal(TaskKind::place, "mug", "", "table"), world, {}, two).steps(),
            "regrasp mug on table, go to rest");
  const Forbidden refused{{"regrasp mug on table", "the hands do not meet"}};
  EXPECT_EQ(ask(goal(TaskKind::place, "mug", "", "table"), world, refused, two).steps(),
            "regrasp mug, place mug on table, go to rest");
  EXPECT_EQ(ask(goal(TaskKind::regrasp, "mug"), world, {}, two).steps(), "regrasp mug");
  world.held_by.clear();
  world.on["mug"] = "table";
  two.arms[1] = {"left_hand", {2.5, 0, 1}, 3};  // reaches both
  EXPECT_EQ(ask(to_shelf, world, {}, two).steps(), "pick mug, place mug on shelf, go to rest");
}

TEST(TaskPlanner, the_same_question_has_the_same_answer) {
  TaskWorld world;
  for (int i = 0; i < 12; ++i) world.on["thing" + std::to_string(i)] = "table";
  world.surfaces["sill"] = {0.4, 1.0, 0.9};
  const Asked first = ask(goal(TaskKind::clear, "", "", "table"), world),
              second = ask(goal(TaskKind::clear, "", "", "table"), world);
  EXPECT_EQ(first.steps(), second.steps());
  EXPECT_TRUE(first.plan.found);
}

// Bad domains.

const char* const kSound = R"(
actions { name: "rest" kind: "go_to" cost: 1 }
actions { name: "up" parameters: "?o:object" kind: "pick" object: "?o" when { is: "hand_empty" })"
                           R"( adds: "held_by_robot ?o" }
tasks {
  name: "t"
  parameters: "?o:object"
  methods {
    variables: "?s:surface"
    when { is: "on_surface ?o ?s" }
    steps { task: "up ?o" }
  }
}
)";

std::string error_of(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  try {
    parse_domain(text.replace(at, what.size(), by), "d.txtpb");
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "no error";
}

TEST(TaskDomain, a_mistake_is_named_with_file_line_and_field) {
  EXPECT_NO_THROW(parse_domain(kSound, "d.txtpb"));
  const auto says = [](const std::string& what, const std::string& by, const std::string& where,
                       const std::string& part) {
    const std::string error = error_of(kSound, what, by);
    EXPECT_TRUE(error.starts_with(where)) << error;
    EXPECT_NE(error.find(part), std::string::npos) << error;
  };
  says("on_surface ?o ?s", "stands_on ?o ?s", "d.txtpb:9:is",
       "\"stands_on\" is no predicate; there is in_contact_zone");
  says("on_surface ?o ?s", "on_surface ?o", "d.txtpb:9:is", "has 2 arguments, not 1");
  says("on_surface ?o ?s", "on_surface ?s ?o", "d.txtpb:9:is",
       "wants a object where ?s is a surface");
  says("on_surface ?o ?s", "on_surface ?x ?s", "d.txtpb:9:is",
       "?x is not declared here; there is ?o, ?s");
  says("?s:surface", "?s:place", "d.txtpb:8:variables", "\"place\" is no type");
  says("?s:surface", "?s", "d.txtpb:8:variables", "it is written ?name:type");
  says("?s:surface", "?n:name", "d.txtpb:9:is", "?s is not declared");
  says("variables: \"?s:surface\"", "variables: [\"?s:surface\", \"?n:name\"]",
       "d.txtpb:8:variables", "no condition before this binds");
  says("up ?o\"", "fly ?o\"", "d.txtpb:10:task",
       "\"fly\" is neither a task nor an action; there is t, rest, up");
  says("up ?o\"", "up\"", "d.txtpb:10:task", "has 1 arguments, not 0");
  says("up ?o\"", "t ?o\"", "d.txtpb:10:task",
       "goes round in a circle before anything is done: t, t");
  says("kind: \"go_to\"", "kind: \"fly\"", "d.txtpb:2:kind",
       "\"fly\" is no action of the robot; there is pick, place");
  says("cost: 1", "cost: -1", "d.txtpb:2:cost", "0 or more");
  says("name: \"up\"", "name: \"rest\"", "d.txtpb:3:name", "there already");
  says("adds: \"held_by_robot ?o\"", "adds: \"not held_by_robot ?o\"", "d.txtpb:3:adds",
       "listed under removes");
  says("name: \"t\"", "nam: \"t\"", "d.txtpb:5:nam", "is no key of Task; the nearest is \"name\"");
}

TEST(TaskDomain, one_that_leads_ever_deeper_ends_with_a_reason) {
  const Domain domain = parse_domain(R"(
    actions { name: "grow" kind: "go_to" changes { of: "room table" by: 1 } }
    tasks { name: "a" methods { steps { task: "grow" } steps { task: "a" } } }
  )",
                                     "d.txtpb");
  TaskWorld world;
  const Plan plan =
      make_plan(domain, make_world(world.facts(), world.scene(), {}), 0, {}, {}, {4000, 24});
  EXPECT_FALSE(plan.found);
  EXPECT_NE(plan.reason.find("ever deeper"), std::string::npos) << plan.reason;
}

TEST(TaskDomain, facts_of_its_own_hold_from_an_action_on) {
  const Domain domain = parse_domain(R"(
    predicates { name: "wiped" types: "surface" }
    actions { name: "wipe" parameters: "?s:surface" kind: "go_to" surface: "?s"
      when { is: "not wiped ?s" } adds: "wiped ?s" cost: 2 }
    tasks { name: "wipe_all" methods { steps { all { variables: "?s:surface"
      steps: "wipe ?s" } } } }
  )",
                                     "d.txtpb");
  TaskWorld world;
  const Plan plan =
      make_plan(domain, make_world(world.facts(), world.scene(), {}), 0, {}, {}, {4000, 24});
  ASSERT_TRUE(plan.found) << plan.reason;
  EXPECT_EQ(plan.actions.size(), 2u);
  EXPECT_EQ(plan.cost, 4);
}

}  // namespace
}  // namespace handsel::supervisor::task_planner_test
