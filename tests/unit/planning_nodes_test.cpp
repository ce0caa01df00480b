// The nodes of path planner, collision checker and cost map on LocalBus.
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/local_bus.hpp"
#include "components/collision_checker/node.hpp"
#include "components/costmap/node.hpp"
#include "components/path_planner/node.hpp"
#include "tests/support/planar_arm.hpp"

namespace handsel {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

template <class M>
struct Heard {
  std::vector<M> messages;
  void listen(Bus& bus) {
    bus.subscribe<M>([this](const M& m, const Receipt&) { messages.push_back(m); });
  }
};

class Nodes : public ::testing::Test {
 protected:
  Nodes() : network_(5) {
    setenv("HANDSEL_HOME", (std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy").c_str(), 1);
    context_.robot = std::make_shared<const RobotModel>(test::planar_arm());
    context_.objects = [](const std::string&) -> const ObjectModel* { return nullptr; };
    context_.settings = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy/config";
    scene_.robot_known = true;
    scene_.robot_position = Vector::Zero(3);
    scene_.boxes.push_back({"wall", make_pose({0.75, 0, 0}), {0.3, 0.06, 0.4}, false});
    Bus& spark = network_.add("spark");
    scene_out_ = spark.advertise<Scene>();
    people_out_ = spark.advertise<HumanState>();
    spark.every(milliseconds(50), [this](TimePoint) {
      if (!perceiving_) return;
      scene_out_->publish(scene_);
      people_out_->publish(people_);
    });
  }
  void put_person(const Vector3& feet) {
    Person person;
    person.id = "anna";
    person.joints = standing_body(feet, M_PI, 1.75);
    people_.people = {person};
  }

  LocalNetwork network_;
  NodeContext context_;
  Scene scene_;
  HumanState people_;
  bool perceiving_{true};
  std::unique_ptr<Publisher<Scene>> scene_out_;
  std::unique_ptr<Publisher<HumanState>> people_out_;
};

class PathNode : public Nodes {
 protected:
  PathNode() {
    node_ = std::make_unique<path_planner::Node>(network_.add("path_planner"), context_);
    Bus& client = network_.add("manipulation_planner");
    request_out_ = client.advertise<PathRequest>();
    heard_.listen(client);
  }
  PathRequest request(std::uint64_t number) const {
    PathRequest r;
    r.id = {9, number};
    r.group = "all";
    r.start = Vector3(-0.6, 0, 0);
    r.goals = {Vector3(0.6, 0, 0)};
    r.seed = 3;
    return r;
  }
  bool wait(std::size_t replies) {
    return network_.run_until([&] { return heard_.messages.size() >= replies; }, network_.now() + seconds(20));
  }
  std::unique_ptr<path_planner::Node> node_;
  std::unique_ptr<Publisher<PathRequest>> request_out_;
  Heard<PathReply> heard_;
};

TEST_F(PathNode, plans_once_and_repeats_the_same_answer) {
  network_.run_for(milliseconds(200));
  request_out_->publish(request(1));
  request_out_->publish(request(1));
  ASSERT_TRUE(wait(1));
  network_.run_for(seconds(3));
  ASSERT_EQ(heard_.messages.size(), 1u);
  const PathReply first = heard_.messages[0];
  EXPECT_TRUE(first.solved) << first.reason;
  EXPECT_EQ(first.id, (RequestId{9, 1}));
  EXPECT_GE(first.path.size(), 3u);
  request_out_->publish(request(1));
  ASSERT_TRUE(wait(2));
  EXPECT_EQ(heard_.messages[1].path, first.path);
  EXPECT_EQ(heard_.messages[1].checks, first.checks);
}

TEST_F(PathNode, says_why_not) {
  network_.run_for(milliseconds(200));
  PathRequest wrong = request(1);
  wrong.group = "tentacle";
  request_out_->publish(wrong);
  ASSERT_TRUE(wait(1));
  EXPECT_THAT(heard_.messages[0].reason, HasSubstr("tentacle"));
  PathRequest blocked = request(2);
  blocked.goals = {Vector3(0, 0, 0)};
  request_out_->publish(blocked);
  ASSERT_TRUE(wait(2));
  EXPECT_THAT(heard_.messages[1].reason, HasSubstr("box wall"));
}

TEST_F(PathNode, without_perception_there_is_no_plan) {
  perceiving_ = false;
  network_.run_for(milliseconds(200));
  request_out_->publish(request(1));
  ASSERT_TRUE(wait(1));
  EXPECT_FALSE(heard_.messages[0].solved);
  EXPECT_THAT(heard_.messages[0].reason, HasSubstr("scene"));
}

TEST_F(PathNode, an_older_request_than_one_already_asked_is_superseded) {
  network_.run_for(milliseconds(200));
  request_out_->publish(request(5));
  ASSERT_TRUE(wait(1));
  request_out_->publish(request(4));
  ASSERT_TRUE(wait(2));
  EXPECT_FALSE(heard_.messages[1].solved);
  EXPECT_THAT(heard_.messages[1].reason, HasSubstr("superseded"));
}

class CheckerNode : public Nodes {
 protected:
  CheckerNode() {
    node_ = std::make_unique<collision_checker::Node>(network_.add("collision_checker"), context_);
    Bus& controller = network_.add("trajectory_controller");
    active_out_ = controller.advertise<ActiveTrajectory>();
    forecasts_.listen(controller);
    controller.every(milliseconds(20), [this](TimePoint) {
      if (controlling_) active_out_->publish(active_);
    });
    active_.robot = context_.robot->name();
    active_.position = Vector3(-0.5, 0, 0);
    active_.velocity = active_.acceleration = Vector::Zero(3);
  }
  std::unique_ptr<collision_checker::Node> node_;
  std::unique_ptr<Publisher<ActiveTrajectory>> active_out_;
  Heard<TrajectoryForecast> forecasts_;
  ActiveTrajectory active_;
  bool controlling_{true};
};

TEST_F(CheckerNode, forecasts_fifty_times_a_second_and_falls_silent_without_its_sources) {
  network_.run_for(seconds(1));
  forecasts_.messages.clear();
  network_.run_for(seconds(1));
  EXPECT_NEAR(static_cast<double>(forecasts_.messages.size()), 50, 2);
  EXPECT_FALSE(forecasts_.messages.back().collides);
  perceiving_ = false;
  network_.run_for(seconds(1));
  forecasts_.messages.clear();
  network_.run_for(seconds(1));
  EXPECT_TRUE(forecasts_.messages.empty());
}

TEST_F(CheckerNode, sees_the_wall_ahead) {
  active_.trajectory = 3;
  active_.speed_factor = 1;
  active_.axes = {0};
  active_.rest.axes = {{{-0.5, 0.5, 0}, {{2.0, 0.0}}}};
  network_.run_for(milliseconds(400));
  ASSERT_FALSE(forecasts_.messages.empty());
  EXPECT_TRUE(forecasts_.messages.back().collides);
  EXPECT_THAT(forecasts_.messages.back().reason, HasSubstr("box wall"));
}

TEST_F(CheckerNode, answers_queries) {
  Bus& client = network_.add("handsel");
  auto query_out = client.advertise<StateQuery>();
  Heard<StateVerdict> verdicts;
  verdicts.listen(client);
  network_.run_for(milliseconds(200));
  StateQuery query;
  query.id = {4, 4};
  query.states = {Vector3(0, 0, 0), Vector3(1.2, 0, 0)};
  query_out->publish(query);
  ASSERT_TRUE(network_.run_until([&] { return !verdicts.messages.empty(); }, network_.now() + seconds(2)));
  EXPECT_EQ(verdicts.messages[0].id, query.id);
  EXPECT_EQ(verdicts.messages[0].free, (std::vector<std::uint8_t>{0, 1}));
}

TEST_F(Nodes, the_cost_map_follows_the_person_and_no_faster_than_its_period) {
  costmap::Node node(network_.add("costmap"), context_);
  Bus& reader = network_.add("path_planner");
  Heard<Costmap> maps;
  maps.listen(reader);
  network_.run_for(seconds(2));
  EXPECT_TRUE(maps.messages.empty()) << "nobody is there";
  put_person({1.5, 0, 0});
  network_.run_for(milliseconds(1500));
  ASSERT_FALSE(maps.messages.empty());
  EXPECT_EQ(maps.messages[0].person, "anna");
  EXPECT_LE(maps.messages.size(), 3u) << "a still person needs no new maps";
  const std::uint64_t revision = maps.messages.back().revision;
  maps.messages.clear();
  for (int i = 1; i <= 20; ++i) {
    put_person({1.5 + 0.04 * i, 0, 0});
    network_.run_for(milliseconds(50));
  }
  EXPECT_GT(maps.messages.back().revision, revision);
  EXPECT_LE(maps.messages.size(), 11u);
}

}  // namespace
}  // namespace handsel
