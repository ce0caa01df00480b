// SPDX-License-Identifier: Apache-2.0
// The nodes of path planner, collision checker and cost map on LocalBus.
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/local_bus.hpp"
#include "common/messages/system.hpp"
#include "components/collision_checker/node.hpp"
#include "components/costmap/node.hpp"
#include "components/path_planner/held_digits.hpp"
#include "components/path_planner/node.hpp"
#include "tests/support/cost_layer.hpp"
#include "tests/support/planar_arm.hpp"

namespace handsel::planning_nodes_test {
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
    context_.objects = [this](const std::string& model) -> const ObjectModel* {
      return model == "box" ? box_ : nullptr;
    };
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
  const ObjectModel* box_{};  ///< the model "box"; null: unknown
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
    return network_.run_until([&] { return heard_.messages.size() >= replies; },
                              network_.now() + seconds(20));
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

/// A person who holds a box before the arm.
class PathNodeBesideHand : public PathNode {
 protected:
  PathNodeBesideHand() {
    model_.parts.push_back({Box{{0.06, 0.06, 0.05}}, Pose::Identity()});
    box_ = &model_;
    scene_.boxes.clear();
    scene_.objects.push_back({"thing", "box", make_pose({0.7, 0, 0}), Holder::human, "anna", 0});
    put_person({1.4, 0, -1.2});
    Person& anna = people_.people.front();
    anna.joints[static_cast<std::size_t>(body_joint_index("r_hand"))].position = {0.76, 0, 0};
    anna.joints[static_cast<std::size_t>(body_joint_index("r_wrist"))].position = {0.8, 0, -0.07};
    anna.palms.push_back({"r_hand", -Vector3::UnitX()});
  }

  /// Returns a configuration in which the arm touches the digits but not the rest of the person.
  Vector touching_digits() {
    path_planner::HeldDigits digits(context_.objects, 1, 0.0);
    digits.add(scene_, people_);
    HumanState with_digits = people_;
    with_digits.robots = digits.obstacles(scene_, people_, {});
    CollisionWorld body(*context_.robot, context_.objects), all(*context_.robot, context_.objects);
    body.set_scene(scene_);
    body.set_people(people_);
    all.set_scene(scene_);
    all.set_people(with_digits);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> angle(-1.2, 1.2);
    for (int i = 0; i < 100000; ++i) {
      const Vector q = Vector3(angle(random), angle(random), angle(random));
      if (body.check(q).free && !all.check(q).free) return q;
    }
    ADD_FAILURE() << "the arm cannot touch a digit alone";
    return Vector::Zero(3);
  }

  ObjectModel model_;
};

TEST_F(PathNodeBesideHand, paths_stay_clear_of_the_digits_of_a_hand_that_holds_an_object) {
  network_.run_for(milliseconds(200));
  PathRequest into = request(1);
  into.start = Vector3(-1.5, 0, 0);
  into.goals = {touching_digits()};
  request_out_->publish(into);
  ASSERT_TRUE(wait(1));
  EXPECT_THAT(heard_.messages.back().reason, HasSubstr("digits of anna"));

  into.id.number = 2;
  into.allowed_contacts = {"anna"};  // the handover is engaged
  request_out_->publish(into);
  ASSERT_TRUE(wait(2));
  EXPECT_TRUE(heard_.messages.back().solved) << heard_.messages.back().reason;

  PathRequest out = into;
  out.id.number = 3;
  out.allowed_contacts = {};
  std::swap(out.start, out.goals.front());  // a hand that touches digits leaves them
  request_out_->publish(out);
  ASSERT_TRUE(wait(3));
  EXPECT_TRUE(heard_.messages.back().solved) << heard_.messages.back().reason;
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

TEST_F(PathNode, what_is_cancelled_is_answered_at_once_and_planned_no_more) {
  network_.run_for(milliseconds(200));
  const auto cancel = [this](std::uint64_t number) {
    PathRequest r;
    r.id = {9, number};
    r.group = "all";
    r.cancel = true;
    request_out_->publish(r);
  };
  request_out_->publish(request(1));
  ASSERT_TRUE(wait(1));
  PathRequest hard = request(3);
  hard.start = Vector3(-0.6, 0, 0);
  request_out_->publish(hard);
  network_.run_for(milliseconds(2));
  cancel(3);
  network_.run_for(milliseconds(20));
  ASSERT_EQ(heard_.messages.size(), 2u);
  EXPECT_EQ(heard_.messages[1].id, (RequestId{9, 3}));
  EXPECT_FALSE(heard_.messages[1].solved);
  EXPECT_THAT(heard_.messages[1].reason, HasSubstr("cancelled"));
  request_out_->publish(request(2));  // a late request
  ASSERT_TRUE(wait(3));
  EXPECT_THAT(heard_.messages[2].reason, HasSubstr("cancelled"));
  request_out_->publish(request(4));
  ASSERT_TRUE(wait(4));
  EXPECT_TRUE(heard_.messages[3].solved);
  network_.run_for(seconds(3));
  EXPECT_EQ(heard_.messages.size(), 4u);
}

/// A path of the arm's tip from one side to the other, and an external cost layer on the straight
/// line.
class PathNodeAndOutsider : public PathNode {
 protected:
  PathNodeAndOutsider() {
    scene_.boxes.clear();
    Bus& outsider = network_.add("crowd_estimator");
    layer_out_ = outsider.advertise<Costmap>();
    outsider.every(milliseconds(100), [this](TimePoint) {
      if (layer_) layer_out_->publish(*layer_);
    });
    health_.listen(network_.add("supervisor"));
  }
  PathReply ask(std::uint64_t number) {
    const std::size_t before = heard_.messages.size();
    request_out_->publish(request(number));
    EXPECT_TRUE(wait(before + 1));
    return heard_.messages.back();
  }
  /// Highest at full stretch straight ahead, nothing half a meter away.
  static Costmap hill() {
    Costmap map = crowd(0);
    for (std::size_t i = 0; i < map.values.size(); ++i) {
      const double x = static_cast<double>(i % map.nx),
                   y = static_cast<double>(i / map.nx % map.ny);
      const double away =
          (map.origin + map.resolution * Vector3(x, y, 0) - Vector3(1.2, 0, -0.3)).head<2>().norm();
      map.values[i] = static_cast<std::uint8_t>(254 * std::max(0.0, 1 - away / 0.5));
    }
    return map;
  }
  static Costmap crowd(std::uint8_t value) {
    return test::box_layer("crowd", {0, -1.4, -0.3}, {1.4, 1.4, 0.3}, {0.9, -0.25, -0.3},
                           {1.4, 0.25, 0.3}, value, 3.0);
  }
  /// The layer's cost along a path [rad], and whether it forbids a place of it.
  std::pair<double, bool> along(const PathReply& reply, const Costmap& layer) const {
    HumanCost cost(*context_.robot, {});
    LayersNow layers;
    layers.outside.push_back(std::make_shared<const CostGrid>(layer));
    cost.set_layers(layers);
    double sum = 0;
    bool forbidden = false;
    for (std::size_t k = 0; k + 1 < reply.path.size(); ++k)
      for (int i = 0; i <= 200; ++i) {
        const Vector q = reply.path[k] + (reply.path[k + 1] - reply.path[k]) * (i / 200.0);
        sum += cost(q) * (reply.path[k + 1] - reply.path[k]).norm() / 201;
        forbidden = forbidden || cost.forbidden(q).layer != nullptr;
      }
    return {sum, forbidden};
  }
  std::string complaint() const {
    for (auto it = health_.messages.rbegin(); it != health_.messages.rend(); ++it)
      if (it->component == "path_planner") return it->reason;
    return "silent";
  }
  std::optional<Costmap> layer_;
  std::unique_ptr<Publisher<Costmap>> layer_out_;
  Heard<ComponentHealth> health_;
};

TEST_F(PathNodeAndOutsider, a_layer_published_from_outside_bends_the_path) {
  network_.run_for(milliseconds(300));
  const PathReply straight = ask(1);
  ASSERT_TRUE(straight.solved) << straight.reason;
  EXPECT_EQ(straight.path.size(), 2u);
  EXPECT_EQ(straight.cost, 0.0);
  const double through = along(straight, hill()).first;
  EXPECT_GT(through, 0.5);

  layer_ = hill();
  network_.run_for(milliseconds(300));
  const PathReply bent = ask(2);
  ASSERT_TRUE(bent.solved) << bent.reason;
  EXPECT_LT(along(bent, *layer_).first, 0.5 * through);
  EXPECT_NEAR(along(bent, *layer_).first, bent.cost, 0.1);
  EXPECT_GT(bent.length, straight.length + 0.1);
  EXPECT_EQ(complaint(), "");
}

TEST_F(PathNodeAndOutsider, what_it_forbids_is_kept_off_and_a_goal_there_is_refused) {
  layer_ = crowd(255);
  network_.run_for(milliseconds(300));
  const PathReply around = ask(1);
  ASSERT_TRUE(around.solved) << around.reason;
  EXPECT_FALSE(along(around, *layer_).second);
  PathRequest into = request(2);
  into.goals = {Vector3(0, 0, 0)};
  request_out_->publish(into);
  ASSERT_TRUE(wait(2));
  EXPECT_FALSE(heard_.messages[1].solved);
  EXPECT_THAT(heard_.messages[1].reason, HasSubstr("cost layer crowd forbids"));
  PathRequest out_of = request(3);
  out_of.start = Vector3(0, 0, 0);
  request_out_->publish(out_of);
  ASSERT_TRUE(wait(3));
  EXPECT_TRUE(heard_.messages[2].solved) << "the arm may leave: " << heard_.messages[2].reason;
}

TEST_F(PathNodeAndOutsider, a_layer_that_falls_silent_is_named_and_counts_no_more) {
  layer_ = crowd(254);
  network_.run_for(milliseconds(300));
  layer_.reset();
  network_.run_for(milliseconds(1500));
  EXPECT_THAT(complaint(), HasSubstr("cost layer \"crowd\""));
  EXPECT_EQ(ask(1).path.size(), 2u);
  layer_ = crowd(254);
  network_.run_for(milliseconds(500));
  EXPECT_EQ(complaint(), "");
  EXPECT_GT(ask(2).path.size(), 2u);
}

TEST_F(PathNodeAndOutsider, a_layer_of_the_wrong_size_never_gets_in) {
  layer_ = crowd(254);
  layer_->nz = 1;
  layer_->values.resize(std::size_t{layer_->nx} * layer_->ny);
  network_.run_for(milliseconds(500));
  EXPECT_THAT(complaint(), HasSubstr("two points along each axis"));
  EXPECT_EQ(ask(1).path.size(), 2u);
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
  ASSERT_TRUE(
      network_.run_until([&] { return !verdicts.messages.empty(); }, network_.now() + seconds(2)));
  EXPECT_EQ(verdicts.messages[0].id, query.id);
  EXPECT_EQ(verdicts.messages[0].free, (std::vector<std::uint8_t>{0, 1}));
}

TEST_F(CheckerNode, queries_beyond_the_quota_are_refused_with_the_reason_and_later_ones_answered) {
  Bus& client = network_.add("handsel");
  auto query_out = client.advertise<StateQuery>();
  Heard<StateVerdict> verdicts;
  verdicts.listen(client);
  ComponentHealth health;
  client.subscribe<ComponentHealth>([&](const ComponentHealth& m, const Receipt&) {
    if (m.component == "collision_checker") health = m;
  });
  network_.run_for(milliseconds(200));
  StateQuery query;
  query.states.assign(100, Vector3(1.2, 0, 0));
  for (std::uint64_t i = 1; i <= 50; ++i) {
    query.id = {i, 1};
    query_out->publish(query);
  }
  ASSERT_TRUE(network_.run_until([&] { return verdicts.messages.size() == 50; },
                                 network_.now() + seconds(5)));
  const auto refused = std::count_if(
      verdicts.messages.begin(), verdicts.messages.end(), [](const StateVerdict& verdict) {
        return verdict.reason.find("16 queries wait already") != std::string::npos;
      });
  EXPECT_EQ(refused, 34);
  query.id = {99, 1};
  query_out->publish(query);
  ASSERT_TRUE(network_.run_until([&] { return verdicts.messages.size() == 51; },
                                 network_.now() + seconds(5)));
  EXPECT_EQ(verdicts.messages.back().free.front(), 1);
  network_.run_for(milliseconds(300));
  ASSERT_EQ(health.left_out.size(), 1u);
  EXPECT_EQ(health.left_out[0].name, "state queries: too many wait");
  EXPECT_EQ(health.left_out[0].count, 34u);
}

TEST_F(CheckerNode, a_layer_from_outside_raises_the_cost_ahead) {
  active_.trajectory = 3;
  active_.speed_factor = 1;
  active_.axes = {0};
  active_.rest.axes = {{{-0.5, 0.5, 0}, {{2.0, 0.0}}}};
  scene_.boxes.clear();
  network_.run_for(milliseconds(300));
  ASSERT_FALSE(forecasts_.messages.empty());
  EXPECT_EQ(forecasts_.messages.back().cost, 0.0);
  Bus& outsider = network_.add("crowd_estimator");
  const auto layer_out = outsider.advertise<Costmap>();
  layer_out->publish(test::box_layer("crowd", {0, -1.4, -0.3}, {1.4, 1.4, 0.3}, {0.9, -0.25, -0.3},
                                     {1.4, 0.25, 0.3}, 254, 0.5));
  network_.run_for(milliseconds(300));
  EXPECT_NEAR(forecasts_.messages.back().cost, 0.5, 1e-6);
  network_.run_for(milliseconds(1500));
  EXPECT_EQ(forecasts_.messages.back().cost, 0.0) << "not sent again within a second";
}

TEST_F(CheckerNode,
       a_large_batch_is_answered_in_order_and_a_query_that_makes_no_sense_with_a_reason) {
  Bus& client = network_.add("handsel");
  auto query_out = client.advertise<StateQuery>();
  Heard<StateVerdict> verdicts;
  verdicts.listen(client);
  network_.run_for(milliseconds(200));
  StateQuery query;
  query.id = {4, 4};
  for (int i = 0; i < 2000; ++i) query.states.push_back(Vector3(-1.5 + 0.0015 * i, 0, 0));
  query_out->publish(query);
  ASSERT_TRUE(
      network_.run_until([&] { return !verdicts.messages.empty(); }, network_.now() + seconds(5)));
  const StateVerdict& batch = verdicts.messages[0];
  ASSERT_EQ(batch.free.size(), query.states.size());
  for (std::size_t i = 0; i < query.states.size(); ++i) {
    const double turn = std::abs(query.states[i][0]);
    if (turn < 0.1 || turn > 0.3) {
      EXPECT_EQ(batch.free[i] != 0, turn > 0.3) << i;
    }
  }
  EXPECT_THAT(batch.reason, HasSubstr("box wall"));

  query.id = {4, 5};
  query.states = {Vector::Zero(7), Vector::Zero(7)};
  query_out->publish(query);
  query.id = {4, 6};
  query.states.clear();
  query_out->publish(query);
  ASSERT_TRUE(network_.run_until([&] { return verdicts.messages.size() == 3; },
                                 network_.now() + seconds(5)));
  EXPECT_EQ(verdicts.messages[1].free, (std::vector<std::uint8_t>{0, 0}));
  EXPECT_THAT(verdicts.messages[1].reason, HasSubstr("7 axes"));
  EXPECT_TRUE(verdicts.messages[2].free.empty());
  EXPECT_THAT(verdicts.messages[2].reason, HasSubstr("no states"));
}

TEST_F(Nodes, the_cost_map_follows_the_person_ten_times_a_second) {
  costmap::Node node(network_.add("costmap"), context_);
  Bus& reader = network_.add("path_planner");
  std::map<std::string, std::vector<Costmap>> maps;
  reader.subscribe<Costmap>(
      [&](const Costmap& map, const Receipt&) { maps[map.layer].push_back(map); });
  network_.run_for(seconds(1));
  EXPECT_TRUE(maps.empty()) << "nobody is there";
  put_person({1.5, 0, 0});
  network_.run_for(milliseconds(1700));
  for (const char* layer : kOwnLayers) {
    ASSERT_FALSE(maps[layer].empty()) << layer;
    EXPECT_EQ(maps[layer][0].person, "anna");
    EXPECT_LE(maps[layer].size(), 4u)
        << "a still person needs no new maps, but repeats for who comes late";
    EXPECT_EQ(maps[layer].back().revision, maps[layer].front().revision);
  }
  maps.clear();
  for (int i = 1; i <= 40; ++i) {
    put_person({1.5 + 0.02 * i, 0, 0});
    network_.run_for(milliseconds(50));
  }
  for (const char* layer : kOwnLayers) {
    EXPECT_GE(maps[layer].size(), 20u) << "two seconds";
    EXPECT_GT(maps[layer].back().revision, maps[layer].front().revision);
    EXPECT_NEAR(maps[layer].back().origin.x() - maps[layer].front().origin.x(), 0.75, 0.08);
  }
  people_.people.clear();
  network_.run_for(milliseconds(300));
  maps.clear();
  network_.run_for(seconds(1));
  EXPECT_TRUE(maps.empty()) << "they left";
  put_person({1.5 + 0.02 * 40, 0, 0});
  network_.run_for(milliseconds(500));
  EXPECT_FALSE(maps["arm_comfort"].empty()) << "and are back where they were";
}

}  // namespace
}  // namespace handsel::planning_nodes_test
