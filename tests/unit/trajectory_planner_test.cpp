#include "components/trajectory_planner/trajectory_planner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/local_bus.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "components/trajectory_planner/node.hpp"
#include "tests/support/planar_arm.hpp"

namespace handsel::trajectory_planner {
namespace {

using ::testing::HasSubstr;

TrajectoryRequest request_over(const std::vector<Vector3>& nodes) {
  TrajectoryRequest request;
  request.id = {7, 1};
  request.group = "all";
  request.start = nodes.front();
  for (const Vector3& node : nodes) request.nodes.push_back(node);
  return request;
}

class Planning : public ::testing::Test {
 protected:
  Result run(const TrajectoryRequest& request) { return plan(robot_, world_, cost_, request, {}); }
  RobotModel robot_{test::planar_arm()};
  CollisionWorld world_{robot_, nullptr};
  HumanCost cost_{robot_, {}};
  TrajectoryRequest bent_{request_over({{-0.6, 0.2, 0}, {0.2, 0.8, 0.1}, {0.3, 0.9, 1.2}})};
};

TEST_F(Planning, smooths_the_corners_inside_the_guard_limits) {
  const Result result = run(bent_);
  ASSERT_TRUE(result.reply.solved) << result.reply.reason;
  EXPECT_EQ(result.reply.id, bent_.id);
  EXPECT_LT(result.reply.trajectory.duration(), result.reply.duration_ptp - 0.05);
  EXPECT_EQ(why_not_within(result.reply.trajectory, robot_.comfort_limits(), 0.1 + 1e-6), "");
  EXPECT_LT((final_state(result.reply.trajectory).position - bent_.nodes.back()).norm(), 1e-9);
  EXPECT_TRUE(result.reply.corners.empty());
  EXPECT_GT(result.checks, 0u);
}

TEST_F(Planning, keeps_the_stop_where_every_transition_collides) {
  Scene scene;
  scene.boxes.push_back({"wall", make_pose({0, 0, 0}), {3, 3, 3}, false});
  world_.set_scene(scene);
  const Result result = run(bent_);
  ASSERT_TRUE(result.reply.solved);
  ASSERT_EQ(result.reply.corners.size(), 1u);
  EXPECT_THAT(result.reply.corners[0].what, HasSubstr("corner 1"));
  EXPECT_THAT(result.reply.corners[0].reason, HasSubstr("collides"));
  EXPECT_NEAR(result.reply.trajectory.duration(), result.reply.duration_ptp, 1e-9);
}

TEST_F(Planning, is_slower_near_people_and_when_asked) {
  const Result alone = run(bent_);
  TrajectoryRequest slow = bent_;
  slow.speed_scale = 0.5;
  EXPECT_GT(run(slow).reply.duration_ptp, 1.3 * alone.reply.duration_ptp);
  HumanState state;
  Person person;
  person.id = "anna";
  person.joints = standing_body({1.5, 0.2, 0}, M_PI, 1.75);
  state.people.push_back(person);
  cost_.set_base(make_pose({0, 0, 1.1}));
  cost_.set_people(state);
  const Result near = run(bent_);
  EXPECT_GT(near.cost, 0.05);
  EXPECT_LT(near.speed_factor, 1);
  EXPECT_GT(near.reply.duration_ptp, alone.reply.duration_ptp);
}

TEST_F(Planning, says_what_is_wrong_with_a_request) {
  TrajectoryRequest bad = bent_;
  bad.group = "tail";
  EXPECT_THAT(run(bad).reply.reason, HasSubstr("tail"));
  bad = bent_;
  bad.nodes[1] = Vector::Zero(2);
  EXPECT_THAT(run(bad).reply.reason, HasSubstr("node"));
  bad = bent_;
  bad.speed_scale = 0;
  EXPECT_THAT(run(bad).reply.reason, HasSubstr("speed_scale"));
  bad = bent_;
  bad.nodes[2][1] = std::nan("");
  EXPECT_FALSE(run(bad).reply.solved);
  bad = bent_;
  bad.start = Vector::Zero(5);
  EXPECT_THAT(run(bad).reply.reason, HasSubstr("start"));
}

TEST(TrajectoryPlannerNode, answers_once_planned_requests_again_and_waits_for_a_scene) {
  LocalNetwork network(3);
  NodeContext context;
  context.robot = std::make_shared<const RobotModel>(test::planar_arm());
  context.settings = HANDSEL_SOURCE_DIR "/deploy/config";
  Node node(network.add("trajectory_planner"), context);
  Bus& tester = network.add("manipulation_planner");
  std::vector<TrajectoryReply> replies;
  tester.subscribe<TrajectoryReply>([&](const TrajectoryReply& reply, const Receipt&) { replies.push_back(reply); });
  const auto requests = tester.advertise<TrajectoryRequest>();
  Bus& world = network.add("spark");
  const auto scenes = world.advertise<Scene>();
  const auto people = world.advertise<HumanState>();
  TrajectoryRequest request = request_over({{-0.6, 0.2, 0}, {0.2, 0.8, 0.1}, {0.3, 0.9, 1.2}});

  requests->publish(request);
  network.run_for(std::chrono::milliseconds(100));
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_FALSE(replies[0].solved);
  EXPECT_THAT(replies[0].reason, HasSubstr("scene"));

  Scene scene;
  scene.robot_known = true;
  scene.robot_position = request.start;
  scenes->publish(scene);
  people->publish(HumanState{});
  network.run_for(std::chrono::milliseconds(20));
  request.id.number = 2;
  requests->publish(request);
  network.run_for(std::chrono::milliseconds(200));
  requests->publish(request);
  network.run_for(std::chrono::milliseconds(50));
  ASSERT_EQ(replies.size(), 3u);
  EXPECT_TRUE(replies[1].solved) << replies[1].reason;
  EXPECT_EQ(replies[1].id, request.id);
  EXPECT_EQ(replies[2].id, request.id);
  EXPECT_EQ(replies[2].trajectory.duration(), replies[1].trajectory.duration());
}

}  // namespace
}  // namespace handsel::trajectory_planner
