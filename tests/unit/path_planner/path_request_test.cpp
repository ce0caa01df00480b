// SPDX-License-Identifier: Apache-2.0
// Requests of every kind at the path planner on LocalBus: configurations, poses, regions, upright,
// Cartesian, beside a head; and invalid ones.
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/local_bus.hpp"
#include "common/model/human/human_body.hpp"
#include "components/path_planner/head_room.hpp"
#include "components/path_planner/node.hpp"
#include "components/path_planner/request.hpp"

namespace handsel::path_planner::path_request_test {
namespace {

using ::testing::HasSubstr;

const RobotModel& jido() {
  static const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  return robot;
}

class PathRequests : public ::testing::Test {
 protected:
  PathRequests() : network_(6), arm_(jido().require_group("arm")) {
    setenv("HANDSEL_HOME", (std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy").c_str(), 1);
    context_.robot = std::shared_ptr<const RobotModel>(std::shared_ptr<void>(), &jido());
    context_.objects = [](const std::string&) -> const ObjectModel* { return nullptr; };
    context_.settings = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy/config";
    scene_.robot_known = true;
    scene_.robot_position = jido().rest_configuration();
    scene_.T_world_base =
        make_pose({1.5, -0.5, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Vector3::UnitZ())));
    Bus& spark = network_.add("spark");
    scene_out_ = spark.advertise<Scene>();
    people_out_ = spark.advertise<HumanState>();
    spark.every(std::chrono::milliseconds(50), [this](TimePoint) {
      scene_out_->publish(scene_);
      people_out_->publish(people_);
    });
    node_ = std::make_unique<Node>(network_.add("path_planner"), context_);
    Bus& client = network_.add("manipulation_planner");
    request_out_ = client.advertise<PathRequest>();
    client.subscribe<PathReply>(
        [this](const PathReply& reply, const Receipt&) { replies_.push_back(reply); });
    network_.run_for(std::chrono::milliseconds(200));
  }

  PathRequest request() {
    PathRequest r;
    r.id = {4, ++number_};
    r.group = "arm";
    r.start = jido().rest_configuration();
    r.seed = 2;
    r.time_limit = 5;
    return r;
  }
  PathReply ask(const PathRequest& r) {
    const std::size_t before = replies_.size();
    request_out_->publish(r);
    EXPECT_TRUE(network_.run_until([&] { return replies_.size() > before; },
                                   network_.now() + std::chrono::seconds(30)));
    return replies_.empty() ? PathReply{} : replies_.back();
  }
  /// The arm moved a bit from rest, and where its tip is then, in the world.
  Vector moved(double by) const {
    Vector q = RobotModel::part(jido().rest_configuration(), arm_);
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] += q[i] > 0 ? -by : by;
    return q;
  }
  Pose tip(const Vector& arm_q) const {
    return scene_.T_world_base *
           jido().link_pose(RobotModel::with(jido().rest_configuration(), arm_, arm_q), arm_.tip);
  }

  LocalNetwork network_;
  NodeContext context_;
  const Group& arm_;
  Scene scene_;
  HumanState people_;
  std::unique_ptr<Publisher<Scene>> scene_out_;
  std::unique_ptr<Publisher<HumanState>> people_out_;
  std::unique_ptr<Node> node_;
  std::unique_ptr<Publisher<PathRequest>> request_out_;
  std::vector<PathReply> replies_;
  std::uint64_t number_{0};
};

TEST_F(PathRequests, a_pose_a_set_of_them_and_a_region_are_reached) {
  PathRequest r = request();
  TipGoal far;
  far.T_world_tip = make_pose({9, 9, 1});
  TipGoal near;
  near.T_world_tip = tip(moved(0.3));
  r.poses = {far, near};
  const PathReply of_set = ask(r);
  ASSERT_TRUE(of_set.solved) << of_set.reason;
  EXPECT_EQ(of_set.goal, 1u);
  EXPECT_EQ(of_set.outcome, PathOutcome::planned);
  const Pose off = near.T_world_tip.inverse() * tip(of_set.path.back());
  EXPECT_LT(off.translation().norm(), 1e-4);
  EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), 1e-3);

  r = request();
  near.slack = Vector3(0.05, 0.02, 0);
  near.turn = 0.5;
  r.poses = {near};
  const PathReply of_region = ask(r);
  ASSERT_TRUE(of_region.solved) << of_region.reason;
  const Pose within = near.T_world_tip.inverse() * tip(of_region.path.back());
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LE(std::abs(within.translation()[axis]), near.slack[axis] + 1e-4);
  EXPECT_LE(Eigen::AngleAxisd(within.linear()).angle(), near.turn + 1e-3);

  r = request();
  r.poses = {far};
  EXPECT_THAT(ask(r).reason, HasSubstr("no configuration of the group \"arm\" reaches the goal"));
}

TEST_F(PathRequests, a_path_keeps_off_heads_as_far_as_its_ends_do) {
  // The arm sweeps from one side to the other; a head is in front of the middle of the path.
  Vector start = jido().rest_configuration(), goal = start, middle = start;
  start[arm_.axes[0]] -= 0.7;
  goal[arm_.axes[0]] += 0.7;
  CollisionWorld world(jido(), context_.objects);
  world.set_scene(scene_);
  const Vector3 p_tip = tip(RobotModel::part(middle, arm_)).translation();
  const Vector3 out =
      (p_tip - scene_.T_world_base.translation()).cwiseProduct(Vector3(1, 1, 0)).normalized();
  const auto head_at = [&](double away) {
    Person person;
    person.id = "anna";
    person.stature = 1.2;
    person.joints = standing_body(Vector3::Zero(), 0, person.stature);
    const Vector3 shift = p_tip + away * out - simplified_body(person).head;
    for (BodyJoint& joint : person.joints) joint.position += shift;
    people_.people = {person};
    people_.covered = true;
  };
  const auto room = [&](const Vector& q) {
    return keep_clear_of_heads(world, people_, 0.5, q, {q});
  };
  double away = 0.1;
  for (head_at(away); room(middle) < 0.1; away += 0.02) head_at(away);
  ASSERT_GT(room(start), 0.3);
  ASSERT_GT(room(goal), 0.3);
  network_.run_for(std::chrono::milliseconds(200));
  PathRequest r = request();
  r.start = start;
  r.goals = {RobotModel::part(goal, arm_)};
  const auto least = [&](const PathReply& reply) {
    double out_of = 1.0;
    for (std::size_t i = 1; i < reply.path.size(); ++i)
      for (int k = 0; k <= 50; ++k)
        out_of = std::min(
            out_of,
            room(RobotModel::with(
                start, arm_, reply.path[i - 1] + 0.02 * k * (reply.path[i] - reply.path[i - 1]))));
    return out_of;
  };
  const PathReply around = ask(r);
  ASSERT_TRUE(around.solved) << around.reason;
  EXPECT_GE(least(around), 0.3 - 1e-9);

  // Nearer goals and starts stay feasible.
  r = request();
  r.start = start;
  r.goals = {RobotModel::part(middle, arm_)};
  const PathReply near = ask(r);
  ASSERT_TRUE(near.solved) << near.reason;
  r.id = request().id;
  r.start = middle;
  r.goals = {RobotModel::part(start, arm_)};
  EXPECT_TRUE(ask(r).solved);
}

TEST_F(PathRequests, what_is_held_stays_upright_in_the_world) {
  // On a tilted base, up is not the z axis of the robot.
  scene_.T_world_base =
      make_pose({0, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Vector3::UnitX())));
  network_.run_for(std::chrono::milliseconds(200));
  PathRequest r = request();
  r.upright = true;
  r.upright_axis =
      (scene_.T_world_base * jido().link_pose(r.start, jido().tool_link())).linear().transpose() *
      Vector3::UnitZ();
  r.max_tilt = 0.25;
  const auto leans = [&](const Vector& arm_q) {
    const Pose T_world_tool =
        scene_.T_world_base *
        jido().link_pose(RobotModel::with(r.start, arm_, arm_q), jido().tool_link());
    return std::acos(std::clamp((T_world_tool.linear() * r.upright_axis)[2], -1.0, 1.0));
  };
  TipGoal aside;
  aside.T_world_tip = tip(RobotModel::part(r.start, arm_));
  aside.T_world_tip.pretranslate(Vector3(0.15, -0.1, 0.1));
  r.poses = {aside};
  const PathReply reply = ask(r);
  ASSERT_TRUE(reply.solved) << reply.reason;
  double most = 0;
  for (std::size_t i = 1; i < reply.path.size(); ++i)
    for (int k = 0; k <= 100; ++k)
      most =
          std::max(most, leans(reply.path[i - 1] + 0.01 * k * (reply.path[i] - reply.path[i - 1])));
  EXPECT_LE(most, r.max_tilt + 1e-6);

  r.id = request().id;
  r.poses.clear();
  r.goals = {moved(0.7)};
  ASSERT_GT(leans(r.goals[0]), r.max_tilt);
  EXPECT_THAT(ask(r).reason, HasSubstr("leans"));
}

TEST_F(PathRequests, in_the_cartesian_space_the_head_may_move_along) {
  PathRequest r = request();
  r.space = PlanSpace::cartesian;
  TipGoal goal;
  goal.T_world_tip = tip(RobotModel::part(r.start, arm_));
  goal.T_world_tip.pretranslate(Vector3(0.05, 0.1, 0.05));
  r.poses = {goal};
  const int pan = jido().require_group("head").axes[0];
  r.also = {static_cast<std::uint32_t>(pan)};
  r.also_goal = Vector::Constant(1, 0.4);
  const PathReply reply = ask(r);
  ASSERT_TRUE(reply.solved) << reply.reason;
  ASSERT_EQ(reply.path.back().size(), static_cast<Eigen::Index>(arm_.axes.size()) + 1);
  EXPECT_NEAR(reply.path.back().tail<1>()[0], 0.4, 1e-9);
  EXPECT_LT((goal.T_world_tip.inverse() * tip(reply.path.back().head(7))).translation().norm(),
            1e-4);
  for (std::size_t i = 1; i < reply.path.size(); ++i)
    EXPECT_LE((reply.path[i] - reply.path[i - 1]).cwiseAbs().maxCoeff(), 0.1 + 1e-9);
}

TEST_F(PathRequests, a_live_one_goes_on_along_the_path_that_runs) {
  PathRequest r = request();
  r.goals = {moved(0.3)};
  const PathReply first = ask(r);
  ASSERT_TRUE(first.solved) << first.reason;
  r = request();
  r.goals = {moved(0.3)};
  r.start = RobotModel::with(r.start, arm_, 0.7 * first.path[0] + 0.3 * first.path[1]);
  r.running = first.path;
  const PathReply on = ask(r);
  ASSERT_TRUE(on.solved) << on.reason;
  EXPECT_EQ(on.outcome, PathOutcome::kept);
  r.id = request().id;
  r.running.clear();
  EXPECT_EQ(ask(r).outcome, PathOutcome::planned);
}

TEST_F(PathRequests, what_contradicts_itself_is_refused_with_its_reason) {
  TipGoal pose;
  pose.T_world_tip = tip(moved(0.2));
  const auto refused = [&](const char* why, auto change) {
    PathRequest r = request();
    r.goals = {moved(0.2)};
    change(r);
    const PathReply reply = ask(r);
    EXPECT_FALSE(reply.solved) << why;
    EXPECT_THAT(reply.reason, HasSubstr(why));
    EXPECT_EQ(reply.outcome, PathOutcome::blocked);
  };
  const auto cartesian = [&](PathRequest& r) {
    r.space = PlanSpace::cartesian;
    r.goals.clear();
    r.poses = {pose};
  };
  refused("no goal was given", [](PathRequest& r) { r.goals.clear(); });
  refused("only one kind", [&](PathRequest& r) { r.poses = {pose}; });
  refused("no group \"tail\"", [](PathRequest& r) { r.group = "tail"; });
  refused("the start has 3 axes", [](PathRequest& r) { r.start = Vector::Zero(3); });
  refused("a goal has 2 axes", [](PathRequest& r) { r.goals = {Vector::Zero(2)}; });
  refused("has no tip", [&](PathRequest& r) {
    r.group = "hand";
    r.goals.clear();
    r.poses = {pose};
  });
  refused("no angle it may lean over", [](PathRequest& r) { r.upright = true; });
  refused("the time limit is zero", [](PathRequest& r) { r.time_limit = 0; });
  refused("asks for a straight line", [](PathRequest& r) {
    r.running = r.goals;
    r.straight = true;
  });
  refused("its goal is a pose", [&](PathRequest& r) {
    r.running = r.goals;
    r.goals.clear();
    r.poses = {pose};
  });
  refused("leads to a pose", [](PathRequest& r) { r.space = PlanSpace::cartesian; });
  refused("leave the choice to it", [&](PathRequest& r) {
    cartesian(r);
    r.planner = PlannerKind::rrt;
  });
  refused("but is one of its own", [&](PathRequest& r) {
    cartesian(r);
    r.also = {0};
    r.also_goal = Vector::Zero(1);
  });
  refused("the robot has 22 axes", [&](PathRequest& r) {
    cartesian(r);
    r.also = {25};
    r.also_goal = Vector::Zero(1);
  });
  refused("for the Cartesian space only", [](PathRequest& r) {
    r.also = {20};
    r.also_goal = Vector::Zero(1);
  });
}

}  // namespace
}  // namespace handsel::path_planner::path_request_test
