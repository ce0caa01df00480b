#include "components/bridge/view.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "common/config/resources.hpp"

namespace handsel::bridge {
namespace {

using Json = nlohmann::json;

struct BridgeView : testing::Test {
  std::shared_ptr<const RobotModel> robot = std::make_shared<RobotModel>(RobotModel::load(robot_description("jido")));
  View view{robot};
  TimePoint now{std::chrono::seconds(10)};

  Json shown() { return Json::parse(view.json(now)); }
  RobotState state() const {
    RobotState s;
    s.robot = "jido";
    s.position = s.velocity = s.effort = robot->rest_posture();
    return s;
  }
};

TEST_F(BridgeView, shows_an_empty_world_before_anything_came) {
  const Json page = shown();
  EXPECT_TRUE(page["robot"].is_null());
  EXPECT_TRUE(page["people"].empty());
  EXPECT_FALSE(page.contains("task"));
}

TEST_F(BridgeView, puts_the_robot_where_its_base_is) {
  RobotState s = state();
  view.take(s, now);
  const Json at_origin = shown()["robot"]["shapes"];
  s.T_world_base.translation() = Vector3(1, 2, 0);
  view.take(s, now);
  const Json moved = shown()["robot"]["shapes"];
  ASSERT_GT(at_origin.size(), 10u);
  ASSERT_EQ(at_origin.size(), moved.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    EXPECT_NEAR(moved[i][0][0].get<double>() - at_origin[i][0][0].get<double>(), 1.0, 2e-4);
    EXPECT_NEAR(moved[i][0][1].get<double>() - at_origin[i][0][1].get<double>(), 2.0, 2e-4);
  }
}

TEST_F(BridgeView, measures_the_nearest_approach) {
  view.take(state(), now);
  HumanState people;
  view.take(people, now);
  EXPECT_TRUE(shown()["separation"]["distance"].is_null());
  Person anna;
  anna.id = "anna";
  anna.joints = standing_body(Vector3(3, 0, 0), M_PI, 1.75);
  people.people.push_back(anna);
  view.take(people, now);
  const Json page = shown();
  EXPECT_GT(page["separation"]["distance"].get<double>(), 0.5);
  EXPECT_LT(page["separation"]["distance"].get<double>(), 3.0);
  EXPECT_EQ(page["separation"]["person"], "anna");
  EXPECT_EQ(page["people"][0]["joints"].size(), kBodyJoints.size());
}

TEST_F(BridgeView, names_mode_causes_task_and_health) {
  ExecutionStatus execution;
  execution.mode = Mode::stop;
  execution.causes = 1u << static_cast<int>(Cause::human_state_silent) | 1u << static_cast<int>(Cause::no_go);
  view.take(execution, now);
  TaskStatus task;
  task.plan = {"pick mug", "give mug to anna"};
  task.step = 1;
  task.state = TaskState::running;
  view.take(task, now);
  ComponentHealth health;
  health.component = "spark";
  health.state = HealthState::degraded;
  health.topics.push_back({.topic = "a", .rate = 10, .deadline_misses = 2, .rejected = 3, .last_rejection = {}});
  health.topics.push_back({.topic = "b", .rate = 20, .deadline_misses = 1, .rejected = 0, .last_rejection = {}});
  view.take(health, now);
  now += std::chrono::seconds(2);
  const Json page = shown();
  EXPECT_EQ(page["execution"]["mode"], "stop");
  EXPECT_EQ(page["execution"]["causes"], (Json{"no_go", "human_state_silent"}));
  EXPECT_EQ(page["task"]["plan"][1], "give mug to anna");
  EXPECT_EQ(page["task"]["step"], 1);
  EXPECT_EQ(page["health"][0]["misses"], 3);
  EXPECT_EQ(page["health"][0]["rate"], 30);
  EXPECT_EQ(page["health"][0]["age"], 2);
}

TEST_F(BridgeView, draws_the_path_of_the_tool_once_a_trajectory) {
  view.take(state(), now);
  ActiveTrajectory active;
  active.trajectory = 7;
  active.position = active.velocity = active.acceleration = robot->rest_posture();
  active.axes = {0};
  active.rest.axes = {{.start = {active.position[0], 0.5, 0.0}, .segments = {{1.0, 0.0}}}};
  view.take(active, now);
  const Json path = shown()["robot"]["path"];
  ASSERT_EQ(path.size(), 41u);
  EXPECT_NE(path.front(), path.back());
  active.trajectory = 0;
  view.take(active, now);
  EXPECT_TRUE(shown()["robot"]["path"].empty());
}

TEST_F(BridgeView, survives_numbers_and_text_that_json_cannot_hold) {
  TrajectoryForecast forecast;
  forecast.time_to_collision = std::numeric_limits<double>::infinity();
  forecast.reason = "\xff\xfe";
  view.take(forecast, now);
  EXPECT_TRUE(shown()["forecast"]["time"].is_null());
}

}  // namespace
}  // namespace handsel::bridge
