// SPDX-License-Identifier: Apache-2.0
// A mobile platform, alone and with its arm: the model, human-aware costs, paths, and requests on
// LocalBus.
#include <cstdlib>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/local_bus.hpp"
#include "components/path_planner/driving.hpp"
#include "components/path_planner/node.hpp"
#include "components/path_planner/path_planner.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::path_planner::driving_test {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kJido =
    std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb";
constexpr double kRoam = 3.0;

class DrivingJido : public ::testing::Test {
 protected:
  static const RobotModel& fixed() {
    static const RobotModel robot = RobotModel::load(kJido);
    return robot;
  }
  static const RobotModel& mobile() {
    static const RobotModel robot = on_platform(fixed(), kJido).value();
    return robot;
  }
  /// At x, y, heading with the arm at rest.
  static Vector at(double x, double y, double heading) {
    Vector q(mobile().dof());
    q << fixed().rest_configuration(), x, y, heading;
    return q;
  }
  Problem problem(const char* group, const Vector& from, const std::vector<Vector>& goals) {
    Problem out;
    out.axes = mobile().require_group(group).axes;
    out.start = from;
    out.goals = goals;
    out.seed = 5;
    navigation_.set_people(people_);
    cost_.set_people(people_);
    world_.set_people(people_);
    exact_.set_people(people_);
    drive(mobile(), navigation_, kRoam, out);
    return out;
  }
  /// The platform at every place of a path keeps seven centimeters to furniture.
  void expect_clear_of(const Scene& scene, const std::vector<Vector>& path) {
    Scene seen = scene;
    seen.T_world_base = Pose::Identity();
    exact_.set_scene(seen);
    for (std::size_t i = 1; i < path.size(); ++i)
      for (int k = 0; k < 50; ++k) {
        const Vector q = path[i - 1] + k / 50.0 * (path[i] - path[i - 1]);
        EXPECT_GT(exact_.distance_to_scene(at(q[0], q[1], q[2]), 1.0), 0.07);
      }
  }
  void obstacles(const std::vector<Obstacle>& all) {
    world_.set_obstacles(all);
    exact_.set_obstacles(all);
  }
  static Obstacle box(const char* id, const Vector3& middle, const Vector3& size) {
    return {id, {Box{size}, make_pose(middle)}};
  }
  /// Every centimeter and half degree, by FCL alone.
  void expect_free_and_inside(const Problem& p, const Result& result) {
    const std::vector<Vector>& path = result.path;
    std::size_t judged = 0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const int pieces =
          static_cast<int>(std::ceil((path[i] - path[i - 1]).cwiseAbs().maxCoeff() / 0.005)) + 1;
      for (int k = 0; k <= pieces; ++k, ++judged) {
        Vector q = p.start;
        for (std::size_t axis = 0; axis < p.axes.size(); ++axis) {
          const auto c = static_cast<Eigen::Index>(axis);
          q[p.axes[axis]] =
              path[i - 1][c] + (static_cast<double>(k) / pieces) * (path[i][c] - path[i - 1][c]);
          ASSERT_GE(q[p.axes[axis]],
                    mobile().axes()[static_cast<std::size_t>(p.axes[axis])].lower - 1e-9);
          ASSERT_LE(q[p.axes[axis]],
                    mobile().axes()[static_cast<std::size_t>(p.axes[axis])].upper + 1e-9);
          ASSERT_GE(q[p.axes[axis]], p.room->first[c] - 1e-9);
          ASSERT_LE(q[p.axes[axis]], p.room->second[c] + 1e-9);
        }
        ASSERT_TRUE(exact_.is_free(q)) << "edge " << i << " at " << k << " of " << pieces;
      }
    }
    EXPECT_EQ(exact_.checks(), exact_.exact_checks());
    EXPECT_GT(judged, 100u);
  }

  HumanState people_;
  CollisionWorld world_{mobile(), nullptr}, exact_{mobile(), nullptr};
  HumanCost cost_{mobile(), {}};
  NavigationCost navigation_{mobile(), {}};
};

TEST_F(DrivingJido, the_links_are_where_the_standing_robot_has_them) {
  std::mt19937 random(11);
  std::vector<Pose> standing, platform_motion;
  for (int k = 0; k < 20; ++k) {
    Vector q = fixed().rest_configuration();
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const Axis& axis = fixed().axes()[static_cast<std::size_t>(i)];
      q[i] = std::uniform_real_distribution<double>(axis.lower, axis.upper)(random);
    }
    std::uniform_real_distribution<double> place(-5, 5);
    const Pose T_world_base =
        make_pose({place(random), place(random), 0},
                  Eigen::Quaterniond(Eigen::AngleAxisd(std::remainder(place(random), 2 * M_PI),
                                                       Vector3::UnitZ())));
    fixed().forward(q, standing);
    mobile().forward(with_platform(q, T_world_base), platform_motion);
    ASSERT_EQ(platform_motion.size(), standing.size() + 3);
    for (std::size_t link = 0; link < standing.size(); ++link) {
      EXPECT_EQ(mobile().links()[link + 3].name, fixed().links()[link].name);
      EXPECT_TRUE(platform_motion[link + 3].isApprox(T_world_base * standing[link], 1e-9))
          << fixed().links()[link].name;
    }
    CollisionWorld alone(fixed(), nullptr);
    EXPECT_EQ(exact_.is_free(with_platform(q, T_world_base)), alone.is_free(q))
        << "the robot against itself";
  }
  for (std::size_t a = 0; a < standing.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_EQ(mobile().pair_disabled(static_cast<int>(a) + 3, static_cast<int>(b) + 3),
                fixed().pair_disabled(static_cast<int>(a), static_cast<int>(b)));
  EXPECT_EQ(mobile().links()[static_cast<std::size_t>(mobile().tool_link())].name, "palm");
}

TEST_F(DrivingJido, people_mind_what_comes_near_comes_from_behind_and_stands_in_their_way) {
  EXPECT_EQ(platform_safety_cost(0.0, 1.3), 1.0);
  EXPECT_EQ(platform_safety_cost(1.3, 1.3), 0.0);
  for (double d = 0.01; d < 1.3; d += 0.01)
    EXPECT_LT(platform_safety_cost(d, 1.3), platform_safety_cost(d - 0.01, 1.3));
  people_ = test::person_at({0, 0, 0});  // the gaze is along -x
  navigation_.set_people(people_);
  EXPECT_EQ(navigation_(-3, 0, 0), 0.0);
  const double before = navigation_(-1.3, 0, M_PI), behind = navigation_(1.3, 0, 0);
  EXPECT_GT(before, 0.0);
  EXPECT_GT(behind, before + 0.02);
  EXPECT_GT(navigation_(-0.9, 0, 0), before);
  EXPECT_NEAR(navigation_(0.5, 1.1, 0.3), navigation_(0.5, -1.1, -0.3), 1e-6)
      << "left and right are the same";
  for (BodyJoint& joint : people_.people[0].joints) joint.velocity = Vector3(0, 1.0, 0);
  NavigationCost walking(mobile(), {});
  walking.set_people(people_);
  EXPECT_GT(walking(0, 2.0, 0), 0.1) << "on the way of somebody who walks";
  EXPECT_EQ(walking(0, -2.2, 0), 0.0);
  EXPECT_EQ(navigation_(0, 2.2, 0), 0.0) << "nobody's way while nobody walks";
}

TEST_F(DrivingJido, the_platform_goes_through_a_door) {
  obstacles({box("wall_left", {1.5, 1.6, 0.6}, {0.2, 2.2, 1.2}),
             box("wall_right", {1.5, -1.6, 0.6}, {0.2, 2.2, 1.2})});
  const Problem p =
      problem("platform", at(0, -1, 1.5), {Vector3(3, 1, -M_PI + 0.1), Vector3(1.5, 1.6, 0)});
  const Result result = plan(mobile(), world_, cost_, p, {});
  ASSERT_TRUE(result.solved) << result.reason;
  EXPECT_EQ(result.goal, 0u);
  EXPECT_NEAR(std::remainder(result.path.back()[2] - (-M_PI + 0.1), 2 * M_PI), 0, 1e-9);
  expect_free_and_inside(p, result);
  const Problem into = problem("platform", at(0, -1, 0), {Vector3(1.5, 1.6, 0)});
  EXPECT_THAT(plan(mobile(), world_, cost_, into, {}).reason, HasSubstr("wall_left"));
}

TEST_F(DrivingJido, it_keeps_away_from_a_person_it_could_drive_past) {
  const std::vector<Vector> goal = {Vector3(4, 0, 0)};
  const Problem alone = problem("platform", at(0, 0, 0), goal);
  EXPECT_EQ(plan(mobile(), world_, cost_, alone, {}).path.size(), 2u);
  people_ = test::person_at({2, 0.75, 0});
  const Problem p = problem("platform", at(0, 0, 0), goal);
  Settings settings;
  const Result kept = plan(mobile(), world_, cost_, p, settings);
  Problem straight = p;
  straight.straight = true;
  const Result past = plan(mobile(), world_, cost_, straight, settings);
  ASSERT_TRUE(kept.solved) << kept.reason;
  ASSERT_TRUE(past.solved) << past.reason;
  EXPECT_LT(kept.cost, 0.7 * past.cost);
  EXPECT_GT(kept.length, past.length);
  expect_free_and_inside(p, kept);
}

TEST_F(DrivingJido, furniture_is_kept_clear_of_as_far_as_start_and_goal_allow) {
  Scene scene;
  scene.boxes.push_back({"sideboard", make_pose({2.0, 0, 0.4}), {0.5, 1.0, 0.8}, true});
  const auto distance = [&](const Vector& q) {
    exact_.set_scene(scene);
    return exact_.distance_to_scene(q, 10.0);
  };
  const auto place_at = [&](double clearance) {  // place at which the robot faces the sideboard
    double x = 0;
    while (distance(at(x, 0, 0)) > clearance) x += 0.001;
    return at(x, 0, 0);
  };
  const Vector far = at(0, -2, 0), near = place_at(0.06), nearer = place_at(0.02);
  keep_clear_of_furniture(world_, scene, {0.1}, {far});
  EXPECT_FALSE(world_.is_free(near));
  EXPECT_TRUE(world_.is_free(far));
  keep_clear_of_furniture(world_, scene, {0.1}, {far, near});
  EXPECT_TRUE(world_.is_free(near));
  EXPECT_FALSE(world_.is_free(nearer));
  keep_clear_of_furniture(world_, scene, {0.0}, {far});
  EXPECT_TRUE(world_.is_free(nearer));
}

TEST_F(DrivingJido, the_whole_robot_is_one_request) {
  obstacles({box("table", {2.5, 0, 0.36}, {0.7, 1.2, 0.72}),
             box("shelf", {1.2, 1.2, 0.8}, {0.4, 0.8, 1.6})});
  people_ = test::person_at({2.2, -1.6, 0});
  Problem p = problem("robot", at(0, 0.5, 0.4), {});
  const Pose T_world_tip = mobile().link_pose(at(1.5, -0.3, 0.2), mobile().tool_link());
  const PoseGoals reached =
      reach_with_platform(mobile(), world_, {{T_world_tip, Vector3::Zero(), 0}}, p.start, 3);
  ASSERT_FALSE(reached.goals.empty()) << reached.reason;
  p.goals = reached.goals;
  drive(mobile(), navigation_, kRoam, p);
  const Result result = plan(mobile(), world_, cost_, p, {});
  ASSERT_TRUE(result.solved) << result.reason;
  ASSERT_EQ(result.path.back().size(), 10);
  Vector end = p.start;
  for (std::size_t i = 0; i < p.axes.size(); ++i)
    end[p.axes[i]] = result.path.back()[static_cast<Eigen::Index>(i)];
  EXPECT_LT(
      (mobile().link_pose(end, mobile().tool_link()).translation() - T_world_tip.translation())
          .norm(),
      1e-3);
  expect_free_and_inside(p, result);
}

TEST_F(DrivingJido, a_request_on_the_bus_starts_where_the_robot_stands) {
  setenv("HANDSEL_HOME", (std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy").c_str(), 1);
  LocalNetwork network(8);
  NodeContext context;
  context.robot = std::shared_ptr<const RobotModel>(std::shared_ptr<void>(), &fixed());
  context.description = kJido;
  context.objects = [](const std::string&) -> const ObjectModel* { return nullptr; };
  context.settings = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy/config";
  Scene scene;
  scene.robot_known = true;
  scene.robot_position = fixed().rest_configuration();
  scene.T_world_base =
      make_pose({1, -2, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(3.0, Vector3::UnitZ())));
  scene.boxes.push_back({"table", make_pose({2.5, -2, 0.36}), {0.7, 1.2, 0.72}, true});
  Bus& spark = network.add("spark");
  const auto scene_out = spark.advertise<Scene>();
  const auto people_out = spark.advertise<HumanState>();
  spark.every(std::chrono::milliseconds(50), [&](TimePoint) {
    scene_out->publish(scene);
    people_out->publish({});
  });
  Node node(network.add("path_planner"), context);
  Bus& client = network.add("manipulation_planner");
  const auto out = client.advertise<PathRequest>();
  std::vector<PathReply> replies;
  client.subscribe<PathReply>(
      [&](const PathReply& reply, const Receipt&) { replies.push_back(reply); });
  std::uint64_t number = 0;
  const auto ask = [&](PathRequest r) {
    const std::size_t before = replies.size();
    r.id = {2, ++number};
    network.run_for(std::chrono::milliseconds(200));
    out->publish(r);
    EXPECT_TRUE(network.run_until([&] { return replies.size() > before; },
                                  network.now() + std::chrono::seconds(30)));
    return replies.empty() ? PathReply{} : replies.back();
  };
  PathRequest r;
  r.group = "platform";
  r.start = fixed().rest_configuration();
  r.time_limit = 5;
  r.goals = {Vector3(2.5, -3.5, -3.0)};
  const PathReply drives = ask(r);
  ASSERT_TRUE(drives.solved) << drives.reason;
  EXPECT_LT((drives.path.front() - Vector(Vector3(1, -2, 3.0))).norm(), 1e-6);
  EXPECT_NEAR(drives.path.back()[2], 2 * M_PI - 3.0, 1e-6) << "turns the short way";
  r.goals = {Vector3(4.2, -2, 3.0)};  // on the other side of the table
  const PathReply around = ask(r);
  ASSERT_TRUE(around.solved) << around.reason;
  expect_clear_of(scene, around.path);
  r.goals = {Vector3(2.5, -2, 0)};
  EXPECT_THAT(ask(r).reason, HasSubstr("box table"));
  r.goals.clear();
  r.group = "robot";
  TipGoal above;
  above.T_world_tip = mobile().link_pose(at(1.5, -3.2, 0.2), mobile().tool_link());
  r.poses = {above};
  const PathReply whole = ask(r);
  ASSERT_TRUE(whole.solved) << whole.reason;
  EXPECT_EQ(whole.path.front().size(), 10);
  r.group = "platform";
  EXPECT_THAT(ask(r).reason, HasSubstr("x, y, heading"));
  scene.T_world_base.rotate(Eigen::AngleAxisd(0.1, Vector3::UnitX()));
  r.poses.clear();
  r.goals = {Vector3(2.5, -3.5, 0)};
  EXPECT_THAT(ask(r).reason, HasSubstr("does not stand level"));
}

}  // namespace
}  // namespace handsel::path_planner::driving_test
