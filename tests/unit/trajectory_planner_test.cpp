// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/trajectory_planner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/bus/local_bus.hpp"
#include "common/model/platform.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "components/trajectory_planner/node.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::trajectory_planner::trajectory_planner_test {
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

class MotionPlanning : public ::testing::Test {
 protected:
  Result run(const TrajectoryRequest& request) {
    return plan(robot_, world_, cost_, around_, request, {});
  }
  void beside(const HumanState& people) {
    around_ = {people, make_pose({0, 0, 1.1})};
    cost_.set_base(around_.T_world_base);
    cost_.set_people(people);
  }
  RobotModel robot_{test::planar_arm()};
  CollisionWorld world_{robot_, nullptr};
  HumanCost cost_{robot_, {}};
  Surroundings around_;
  TrajectoryRequest bent_{request_over({{-0.6, 0.2, 0}, {0.2, 0.8, 0.1}, {0.3, 0.9, 1.2}})};
};

TEST_F(MotionPlanning, smooths_the_corners_inside_the_guard_limits) {
  const Result result = run(bent_);
  ASSERT_TRUE(result.reply.solved) << result.reply.reason;
  EXPECT_EQ(result.reply.id, bent_.id);
  EXPECT_LT(result.reply.trajectory.duration(), result.reply.duration_ptp - 0.05);
  EXPECT_EQ(why_not_within(result.reply.trajectory, robot_.comfort_limits(), 0.1 + 1e-6), "");
  EXPECT_LT((final_state(result.reply.trajectory).position - bent_.nodes.back()).norm(), 1e-9);
  EXPECT_TRUE(result.reply.corners.empty());
  EXPECT_GT(result.checks, 0u);
}

TEST_F(MotionPlanning, keeps_the_stop_where_every_transition_collides) {
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

TEST_F(MotionPlanning, is_slower_near_people_and_when_asked) {
  const Result alone = run(bent_);
  TrajectoryRequest slow = bent_;
  slow.speed_scale = 0.5;
  EXPECT_GT(run(slow).reply.duration_ptp, 1.3 * alone.reply.duration_ptp);
  beside(test::person_at({1.5, 0.2, 0}));
  const Result near = run(bent_);
  EXPECT_GT(near.cost, 0.05);
  EXPECT_LT(near.speed_factor, 1);
  EXPECT_GT(near.reply.duration_ptp, alone.reply.duration_ptp);
}

double velocity_share(const RobotModel& robot, const MotionState3& state) {
  return (state.velocity.cwiseAbs().array() / robot.comfort_limits().velocity.array()).maxCoeff();
}

TEST_F(MotionPlanning, along_one_leg_it_is_slow_where_it_costs_people_and_fast_elsewhere) {
  const TrajectoryRequest sweep = request_over({{-1.5, 0, 0}, {1.5, 0, 0}});
  const std::vector<Vector3> places = {{1.7, 0.2, 0}, {0.9, 1.5, 0}, {0.9, -1.5, 0}};
  std::vector<double> slowest;  // shoulder angle at the slowest sample
  for (const Vector3& place : places) {
    beside(test::person_at(place));
    const Result result = run(sweep);
    ASSERT_TRUE(result.reply.solved) << result.reply.reason;
    ASSERT_EQ(result.reply.speeds.size(), 1);
    const SpeedAlong people(robot_, cost_, around_, {});
    const auto cost_at = [&](double x) { return people.at(Vector3(x, 0, 0)).cost; };
    // The speed is at most what the cost allows, and reaches that value on long sections.
    const Trajectory& found = result.reply.trajectory;
    double min_ratio = 1, max_ratio = 0, sum_c = 0, sum_v = 0, sum_cc = 0, sum_vv = 0, sum_cv = 0;
    int count = 0;
    slowest.push_back(0);
    double min_at_cruise = 2;
    for (int i = 1; i < 400; ++i) {
      const MotionState3 state = found.at(found.duration() * i / 400);
      const double x = state.position[0], cost = cost_at(x), ratio = velocity_share(robot_, state);
      EXPECT_LE(ratio, 1 - 0.5 * cost + 0.02) << "at " << x;
      if (std::abs(x) > 1.1) continue;  // beyond: starting and stopping
      if (ratio < min_at_cruise) {
        min_at_cruise = ratio;
        slowest.back() = x;
      }
      min_ratio = std::min(min_ratio, ratio), max_ratio = std::max(max_ratio, ratio);
      sum_c += cost, sum_v += ratio, sum_cc += cost * cost, sum_vv += ratio * ratio,
          sum_cv += cost * ratio, ++count;
    }
    const double correlation =
        (count * sum_cv - sum_c * sum_v) /
        std::sqrt((count * sum_cc - sum_c * sum_c) * (count * sum_vv - sum_v * sum_v));
    std::printf(
        "person at (%.1f, %.1f): speed %.2f to %.2f of the limits, correlation with the cost "
        "%.3f\n",
        place.x(), place.y(), min_ratio, max_ratio, correlation);
    EXPECT_LT(correlation, -0.9);
    EXPECT_GT(max_ratio, min_ratio + 0.05);
  }
  EXPECT_NEAR(slowest[0], 0.1, 0.35);
  EXPECT_GT(slowest[1], 0.5);
  EXPECT_LT(slowest[2], -0.5);
}

TEST_F(MotionPlanning, velocity_acceleration_and_jerk_fall_with_the_cost_to_people) {
  const TrajectoryRequest sweep = request_over({{-0.8, 0, 0}, {0.8, 0, 0}});
  struct Measured {
    double cost, velocity, acceleration, jerk, duration;
  };
  std::vector<Measured> measured;
  for (const double away : {5.0, 1.9, 1.7, 1.5}) {
    beside(test::person_at({away, 0, 0}));
    const Result result = run(sweep);
    ASSERT_TRUE(result.reply.solved) << result.reply.reason;
    const AxisTrajectory& axis = result.reply.trajectory.axes[0];
    const AxisExtremes max_ratio = extremes(axis);
    measured.push_back({result.cost, max_ratio.velocity, max_ratio.acceleration, max_ratio.jerk,
                        result.reply.trajectory.duration()});
    std::printf(
        "person at %.1f m: cost %.2f, at most %.3f rad/s, %.3f rad/s2, %.3f rad/s3; %.2f s\n", away,
        result.cost, max_ratio.velocity, max_ratio.acceleration, max_ratio.jerk,
        result.reply.trajectory.duration());
  }
  for (std::size_t k = 1; k < measured.size(); ++k) {
    EXPECT_GT(measured[k].cost, measured[k - 1].cost);
    EXPECT_LT(measured[k].velocity, 0.97 * measured[k - 1].velocity);
    EXPECT_LT(measured[k].acceleration, 0.97 * measured[k - 1].acceleration);
    EXPECT_LT(measured[k].jerk, 0.97 * measured[k - 1].jerk);
    EXPECT_GT(measured[k].duration, measured[k - 1].duration);
  }
}

TEST_F(MotionPlanning, who_comes_nearer_or_does_not_look_makes_it_slower) {
  HumanState people = test::person_at({1.9, 0.2, 0});
  Person& anna = people.people.front();
  anna.gaze_known = true;
  anna.gaze_origin = find_joint(anna, "head")->position;
  anna.gaze_direction = -Vector3::UnitX();
  const auto factor = [&] {
    beside(people);
    const Result result = run(bent_);
    EXPECT_TRUE(result.reply.solved) << result.reply.reason;
    return std::pair(result.speed_factor, result.reply.trajectory.duration());
  };
  const auto [watching, duration] = factor();
  for (BodyJoint& joint : anna.joints) joint.velocity = Vector3(-0.8, 0, 0);
  const auto [coming, duration_coming] = factor();
  EXPECT_LT(coming, watching - 0.1);
  EXPECT_GT(duration_coming, duration);
  for (BodyJoint& joint : anna.joints) joint.velocity = Vector3(0.8, 0, 0);
  EXPECT_DOUBLE_EQ(factor().first, watching);
  for (BodyJoint& joint : anna.joints) joint.velocity.setZero();
  cost_ = HumanCost(
      robot_,
      {1.0, 3.0, 1.0, 0.0, 0.0});  // no cost of visibility: only the activity of the person differs
  const double seen = factor().first;
  anna.gaze_direction = Vector3::UnitX();
  EXPECT_LT(factor().first, seen - 0.05);
}

TEST_F(MotionPlanning, says_what_is_wrong_with_a_request) {
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
  tester.subscribe<TrajectoryReply>(
      [&](const TrajectoryReply& reply, const Receipt&) { replies.push_back(reply); });
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

/// Jido's trajectory planner and its answers to tool motions.
class ToolMotions : public ::testing::Test {
 protected:
  explicit ToolMotions(const std::filesystem::path& settings = HANDSEL_SOURCE_DIR
                       "/deploy/config") {
    context_.robot = robot_;
    context_.settings = settings;
    context_.description = HANDSEL_SOURCE_DIR "/deploy/robots/jido/jido.txtpb";
    node_ = std::make_unique<Node>(network_.add("trajectory_planner"), context_);
    Bus& tester = network_.add("manipulation_planner");
    tester.subscribe<TrajectoryReply>(
        [this](const TrajectoryReply& reply, const Receipt&) { reply_ = reply; });
    requests_ = tester.advertise<TrajectoryRequest>();
    Bus& world = network_.add("spark");
    scenes_ = world.advertise<Scene>();
    people_ = world.advertise<HumanState>();
    network_.run_for(std::chrono::milliseconds(20));
    request_.group = "arm";
    request_.start = robot_->rest_configuration();
    request_.id = {9, 0};
    home_ = T_world_base_ * robot_->link_pose(request_.start, robot_->require_group("arm").tip);
  }
  void to(const Vector3& moved, const Eigen::Quaterniond& turned = Eigen::Quaterniond::Identity()) {
    TipNode node;
    node.T_world_tip = home_ * Pose(turned);
    node.T_world_tip.translation() += moved;
    node.also = request_.start(std::vector<int>(request_.also.begin(), request_.also.end()));
    request_.poses.push_back(node);
  }
  const TrajectoryReply& ask(const HumanState& people = {}) {
    Scene scene;
    scene.robot_known = true;
    scene.T_world_base = T_world_base_;
    scene.robot_position = request_.start;
    scenes_->publish(scene);
    people_->publish(people);
    network_.run_for(std::chrono::milliseconds(20));
    ++request_.id.number;
    requests_->publish(request_);
    for (int k = 0; k < 100 && reply_.id.number != request_.id.number; ++k)
      network_.run_for(std::chrono::milliseconds(20));
    EXPECT_EQ(reply_.id, request_.id);
    return reply_;
  }
  Pose end() const {
    Vector q = request_.start;
    const Vector at = final_state(reply_.trajectory).position;
    for (std::size_t i = 0; i < reply_.axes.size(); ++i)
      q[reply_.axes[i]] = at[static_cast<Eigen::Index>(i)];
    return T_world_base_ * robot_->link_pose(q, robot_->require_group("arm").tip);
  }
  bool reached(std::size_t node) const {
    return (end().matrix() - request_.poses[node].T_world_tip.matrix()).norm() < 1e-5;
  }

  std::shared_ptr<const RobotModel> robot_{std::make_shared<const RobotModel>(
      RobotModel::load(HANDSEL_SOURCE_DIR "/deploy/robots/jido/jido.txtpb"))};
  NodeContext context_;
  LocalNetwork network_{4};
  std::unique_ptr<Node> node_;
  std::unique_ptr<Publisher<TrajectoryRequest>> requests_;
  std::unique_ptr<Publisher<Scene>> scenes_;
  std::unique_ptr<Publisher<HumanState>> people_;
  TrajectoryRequest request_;
  TrajectoryReply reply_;
  Pose T_world_base_{
      make_pose({0.7, -0.4, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.6, Vector3::UnitZ())))};
  Pose home_;
};

TEST_F(ToolMotions, are_those_of_22_axes_wherever_the_robot_stands) {
  for (const char* group : {"hand", "head"})
    for (const int axis : robot_->require_group(group).axes)
      request_.also.push_back(static_cast<std::uint32_t>(axis));
  to({0, 0.1, 0});
  to({0, 0.1, 0.08}, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3::UnitX())));
  request_.poses[1].also[request_.poses[1].also.size() - 1] += 0.2;
  ask();
  ASSERT_TRUE(reply_.solved) << reply_.reason;
  EXPECT_EQ(reply_.axes.size(), 22u);
  EXPECT_EQ(reply_.trajectory.axes.size(), 22u);
  EXPECT_EQ(reply_.reached, 2u);
  EXPECT_TRUE(reached(1));
  EXPECT_NEAR(final_state(reply_.trajectory).position[21], request_.poses[1].also[14], 1e-6);
  EXPECT_LT(reply_.trajectory.duration(), reply_.duration_ptp);
}

TEST_F(ToolMotions, move_the_platform_as_three_more_axes) {
  for (const char* group : {"hand", "head"})
    for (const int axis : robot_->require_group(group).axes)
      request_.also.push_back(static_cast<std::uint32_t>(axis));
  const Vector mobile = with_platform(request_.start, T_world_base_);
  to({0.3, 0.1, 0.05});
  Vector& also = request_.poses[0].also;
  also.conservativeResize(also.size() + 3);
  also.tail(3) = mobile.tail(3) + Vector3(0.3, 0.1, 0.15);
  for (int i = 0; i < 3; ++i)
    request_.also.push_back(static_cast<std::uint32_t>(robot_->dof() + i));
  ask();
  ASSERT_TRUE(reply_.solved) << reply_.reason;
  ASSERT_EQ(reply_.axes.size(), 25u);
  const auto whole = on_platform(*robot_, context_.description);
  for (int i = 0; i <= 20; ++i) {
    Vector q = mobile;
    const Vector at = reply_.trajectory.at(reply_.trajectory.duration() * i / 20).position;
    for (std::size_t k = 0; k < reply_.axes.size(); ++k)
      q[reply_.axes[k]] = at[static_cast<Eigen::Index>(k)];
    const Vector3 tool = whole->link_pose(q, whole->require_group("arm").tip).translation();
    // On the straight path while the platform moves.
    const Vector3 to_goal = request_.poses[0].T_world_tip.translation() - home_.translation();
    const Vector3 off = (tool - home_.translation()) -
                        to_goal * (tool - home_.translation()).dot(to_goal) / to_goal.squaredNorm();
    EXPECT_LT(off.norm(), 1e-3);
    if (i < 20) continue;
    EXPECT_LT((tool - request_.poses[0].T_world_tip.translation()).norm(), 1e-5);
  }
}

TEST_F(ToolMotions, that_cannot_be_say_why_and_go_as_far_as_they_can) {
  const auto expect = [&](std::size_t nodes, const char* why) {
    ask();
    EXPECT_FALSE(reply_.solved) << why;
    EXPECT_THAT(reply_.reason, HasSubstr(why));
    EXPECT_EQ(reply_.reached, nodes);
    if (nodes > 0) {
      EXPECT_TRUE(reached(nodes - 1)) << why;
      EXPECT_GT(reply_.trajectory.duration(), 0.5);
    }
    request_.poses.resize(1);
  };
  to({0, 0.1, 0});
  to({3, 0, 0});
  expect(1, "node 2 is out of reach");
  to({0, 0.1, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Vector3::UnitZ())));
  expect(1, "half a turn");
  request_.poses[0].also = Vector::Constant(1, 0);
  request_.also = {static_cast<std::uint32_t>(robot_->dof() + 3)};
  expect(0, "cannot be active");
  request_.also.clear();
  request_.poses[0].also.resize(0);
  request_.group = "head";
  expect(0, "shoulder, elbow and wrist");
  request_.group = "arm";
  request_.upright = true;
  request_.upright_axis = home_.linear().transpose() * Vector3::UnitZ();
  request_.max_tilt = 0.05;
  to({0, 0.1, 0},
     Eigen::Quaterniond(Eigen::AngleAxisd(0.5, request_.upright_axis.unitOrthogonal())));
  expect(1, "leans over");
  request_.upright = false;
  // Equal waypoints, and a waypoint at the present pose, give no motion.
  to({0, 0.1, 0});
  to({0, 0.1, 0});
  ask();
  EXPECT_TRUE(reply_.solved) << reply_.reason;
  EXPECT_EQ(reply_.reached, 3u);
}

TEST_F(ToolMotions, are_slower_near_people) {
  to({0, 0.25, 0});
  ask();
  ASSERT_TRUE(reply_.solved) << reply_.reason;
  EXPECT_EQ(reply_.speeds.size(), 0);
  const double alone = reply_.trajectory.duration();
  ask(test::person_at(Vector3(home_.translation().x() + 0.8, home_.translation().y() + 0.3, 0)));
  ASSERT_TRUE(reply_.solved) << reply_.reason;
  ASSERT_EQ(reply_.speeds.size(), 1);
  EXPECT_LT(reply_.speeds[0], 0.9);
  EXPECT_GT(reply_.trajectory.duration(), alone + 0.1);
}

/// The largest velocity, acceleration and jerk beside a person, with settings of one's own.
class WithSettings : public ToolMotions {
 public:
  explicit WithSettings(const std::filesystem::path& settings) : ToolMotions(settings) {}
  void TestBody() override {}
  AxisExtremes largest() {
    Vector to = RobotModel::part(request_.start, robot_->require_group("arm"));
    request_.nodes = {to};
    to[0] += 0.5;
    request_.nodes.push_back(to);
    ask(test::person_at(Vector3(home_.translation().x() + 0.8, home_.translation().y() + 0.3, 0)));
    EXPECT_TRUE(reply_.solved) << reply_.reason;
    AxisExtremes all;
    for (const AxisTrajectory& axis : reply_.trajectory.axes) {
      const AxisExtremes one = extremes(axis);
      all.velocity = std::max(all.velocity, one.velocity);
      all.acceleration = std::max(all.acceleration, one.acceleration);
      all.jerk = std::max(all.jerk, one.jerk);
    }
    return all;
  }
};

TEST(TrajectoryPlannerNode, lowers_each_limit_near_people_as_its_settings_say) {
  const std::filesystem::path shipped = HANDSEL_SOURCE_DIR "/deploy/config";
  const AxisExtremes as_shipped = WithSettings(shipped).largest();
  const test::TemporaryFolder folder;
  std::filesystem::copy(shipped, folder.path() / "config",
                        std::filesystem::copy_options::recursive);
  const std::filesystem::path file = folder.path() / "config/trajectory_planner.txtpb";
  std::ifstream in(file);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  for (const std::string key : {"min_acceleration_factor: ", "min_jerk_factor: "}) {
    const std::size_t at = text.find(key + "0.7");
    ASSERT_NE(at, std::string::npos) << key;
    text.replace(at, key.size() + 3, key + "0.1");
  }
  std::ofstream(file) << text;
  const AxisExtremes gentle = WithSettings(folder.path() / "config").largest();
  EXPECT_LT(gentle.acceleration, 0.9 * as_shipped.acceleration);
  EXPECT_LT(gentle.jerk, 0.9 * as_shipped.jerk);
}

}  // namespace
}  // namespace handsel::trajectory_planner::trajectory_planner_test
