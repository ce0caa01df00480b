// SPDX-License-Identifier: Apache-2.0
// The protocol without a socket: messages to a viewer, its requests, its queue.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "common/config/resources.hpp"
#include "common/messages/system.hpp"
#include "common/model/human/human_body.hpp"
#include "common/topics/topics.hpp"
#include "common/wire/schema.hpp"
#include "components/bridge/catalogue.hpp"
#include "components/bridge/drawing.hpp"
#include "components/bridge/drawing.pb.h"
#include "components/bridge/drawn_urdf.hpp"
#include "components/bridge/foxglove.hpp"
#include "components/bridge/site.hpp"
#include "components/bridge/system_graph.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::bridge::bridge_viewer_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

Bytes bytes(const std::string& text) {
  return std::make_shared<const std::vector<std::uint8_t>>(text.begin(), text.end());
}
std::string body(const Frame& frame) {
  return frame.body ? std::string(frame.body->begin(), frame.body->end()) : std::string();
}
Frame with(const std::string& text) { return {nullptr, {}, bytes(text)}; }

TEST(Outbox, keeps_only_the_newest_of_each_instance_in_its_place) {
  Outbox outbox;
  outbox.put_newest(1, 1, with("a1"));
  outbox.put_newest(1, 2, with("b1"));
  outbox.put_newest(1, 1, with("a2 longer"));
  EXPECT_EQ(outbox.dropped(), 1u);
  EXPECT_EQ(outbox.bytes(), 11u);
  EXPECT_EQ(body(outbox.pop()), "a2 longer");
  EXPECT_EQ(body(outbox.pop()), "b1");
  EXPECT_TRUE(outbox.empty());
  EXPECT_EQ(outbox.bytes(), 0u);
}

TEST(Outbox, queues_are_bounded_and_lose_their_oldest) {
  Outbox outbox({.max_controls = 2, .max_queued = 3, .max_bytes = 1000});
  for (int i = 0; i < 5; ++i) outbox.put_queued(7, with(std::to_string(i)));
  EXPECT_EQ(outbox.dropped(), 2u);
  EXPECT_TRUE(outbox.put(with("first")));
  EXPECT_TRUE(outbox.put(with("second")));
  EXPECT_FALSE(outbox.put(with("third")));
  for (const char* next : {"first", "second", "2", "3", "4"}) EXPECT_EQ(body(outbox.pop()), next);
}

/// For any traffic the bounds hold and the counters match the messages handed out.
TEST(Outbox, bounds_hold_for_random_traffic) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const OutboxSettings settings{.max_controls = 8, .max_queued = 4, .max_bytes = 500};
    Outbox outbox(settings);
    std::uint64_t in = 0, out = 0, forgotten = 0;
    for (int i = 0; i < 3000; ++i) {
      const std::uint32_t subscription = random() % 5;
      const std::string text(random() % 200, 'x');
      switch (random() % 6) {
        case 0:
        case 1:
          outbox.put_newest(subscription, random() % 3, with(text));
          ++in;
          break;
        case 2:
        case 3:
          outbox.put_queued(subscription + 10, with(text));
          ++in;
          break;
        case 4:
          if (!outbox.empty()) {
            outbox.pop();
            ++out;
          }
          break;
        default:
          if (random() % 20 == 0) {
            const std::size_t before = outbox.bytes();
            outbox.forget(subscription);
            EXPECT_LE(outbox.bytes(), before);
            forgotten += 3;  // max number of instances
          }
      }
      EXPECT_LE(outbox.bytes(), std::max<std::size_t>(settings.max_bytes, 200));
    }
    std::size_t waiting = 0;
    while (!outbox.empty()) {
      outbox.pop();
      ++waiting;
    }
    EXPECT_EQ(outbox.bytes(), 0u);
    EXPECT_LE(out + waiting + outbox.dropped(), in);
    EXPECT_GE(out + waiting + outbox.dropped() + forgotten, in);
  }
}

struct ViewerTest : testing::Test {
  Hub hub{[] {
            Catalogue c;
            c.name = "handsel test";
            c.metadata = {{"robot", "jido"}};
            c.parameters = {{"robot", "jido"}, {"domain", "5"}};
            c.channels = {{.topic = "newest",
                           .encoding = "cdr",
                           .schema_name = "A",
                           .schema = "a",
                           .schema_encoding = "omgidl"},
                          {.topic = "queued",
                           .encoding = "cdr",
                           .schema_name = "B",
                           .schema = "b",
                           .schema_encoding = "omgidl",
                           .queued = true},
                          {.topic = "kept",
                           .encoding = "cdr",
                           .schema_name = "C",
                           .schema = "c",
                           .schema_encoding = "omgidl",
                           .kept = true}};
            return c;
          }(),
          [](const std::string& uri) {
            return uri == "package://there" ? Asset{bytes("mesh"), {}}
                                            : Asset{nullptr, "there is no such asset"};
          }};
  Viewer viewer{hub};
  TimePoint now{std::chrono::seconds(10)};

  Json next() {
    const Frame frame = viewer.outbox().pop();
    return frame.text ? Json::parse(*frame.text) : Json();
  }
  void skip_greeting() {
    next();
    next();
  }
  void say(const Json& json) { viewer.text(json.dump(), now += std::chrono::milliseconds(10)); }
  std::string refusal(const std::string& text) {
    viewer.text(text, now += std::chrono::milliseconds(10));
    if (viewer.outbox().empty()) return "silence";
    const Json status = next();
    return status["op"] == "status" && status["level"] == 2 ? status["message"].get<std::string>()
                                                            : "no refusal";
  }
  Sample sample(std::size_t channel, const std::string& text, std::uint64_t instance = 1) {
    return {.channel = channel,
            .instance = instance,
            .gone = false,
            .stamp = 0x0102030405060708,
            .bytes = bytes(text)};
  }
};

TEST_F(ViewerTest, is_greeted_with_the_server_and_its_channels) {
  const Json server = next(), channels = next();
  EXPECT_EQ(server["op"], "serverInfo");
  EXPECT_EQ(server["name"], "handsel test");
  EXPECT_EQ(server["metadata"]["robot"], "jido");
  for (const char* capability : {"time", "connectionGraph", "assets", "parameters"})
    EXPECT_THAT(server["capabilities"].dump(), HasSubstr(capability));
  EXPECT_THAT(server["capabilities"].dump(), testing::Not(HasSubstr("clientPublish")));
  EXPECT_EQ(channels["op"], "advertise");
  EXPECT_EQ(channels["channels"][1], (Json{{"id", 2},
                                           {"topic", "queued"},
                                           {"encoding", "cdr"},
                                           {"schemaName", "B"},
                                           {"schema", "b"},
                                           {"schemaEncoding", "omgidl"}}));
}

TEST_F(ViewerTest, gets_only_what_it_subscribed_to_and_the_bytes_as_they_were) {
  skip_greeting();
  say({{"op", "subscribe"}, {"subscriptions", {{{"id", 300}, {"channelId", 1}}}}});
  viewer.sample(sample(0, "cdr"));
  viewer.sample(sample(1, "other"));
  const Frame frame = viewer.outbox().pop();
  EXPECT_EQ(frame.head, (std::vector<std::uint8_t>{1, 0x2c, 1, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1}));
  EXPECT_EQ(body(frame), "cdr");
  EXPECT_TRUE(viewer.outbox().empty());
  viewer.sample(sample(0, "waits"));
  say({{"op", "unsubscribe"}, {"subscriptionIds", {300}}});
  EXPECT_TRUE(viewer.outbox().empty());
  EXPECT_FALSE(viewer.wants(0));
}

TEST_F(ViewerTest, a_late_one_gets_what_is_kept_of_living_instances) {
  skip_greeting();
  hub.keep(sample(2, "old", 1));
  hub.keep(sample(2, "new", 1));
  hub.keep(sample(2, "dead", 2));
  hub.keep({.channel = 2, .instance = 2, .gone = true, .stamp = 0, .bytes = nullptr});
  hub.keep(sample(0, "not kept"));
  say({{"op", "subscribe"},
       {"subscriptions", {{{"id", 1}, {"channelId", 3}}, {{"id", 2}, {"channelId", 1}}}}});
  EXPECT_EQ(body(viewer.outbox().pop()), "new");
  EXPECT_TRUE(viewer.outbox().empty());
}

TEST_F(ViewerTest, queued_topics_keep_order_and_newest_topics_the_newest) {
  skip_greeting();
  say({{"op", "subscribe"},
       {"subscriptions", {{{"id", 1}, {"channelId", 1}}, {{"id", 2}, {"channelId", 2}}}}});
  for (const char* text : {"1", "2", "3"}) {
    viewer.sample(sample(0, text));
    viewer.sample(sample(1, text));
  }
  for (const char* next : {"3", "1", "2", "3"}) EXPECT_EQ(body(viewer.outbox().pop()), next);
}

TEST_F(ViewerTest, broken_and_foreign_messages_are_refused_in_one_sentence) {
  skip_greeting();
  EXPECT_THAT(refusal("{"), HasSubstr("JSON object"));
  EXPECT_THAT(refusal("[1]"), HasSubstr("JSON object"));
  EXPECT_THAT(refusal("\xff\xfe"), HasSubstr("JSON object"));
  EXPECT_THAT(refusal(std::string(60000, '[')), HasSubstr("JSON object"));
  EXPECT_THAT(refusal("{}"), HasSubstr("\"op\""));
  EXPECT_THAT(refusal(R"({"op":"advertise","channels":[]})"),
              HasSubstr("\"advertise\" is not offered"));
  EXPECT_THAT(refusal(R"({"op":"setParameters","parameters":[]})"), HasSubstr("only shows"));
  EXPECT_THAT(refusal(R"({"op":"subscribe"})"), HasSubstr("the field subscriptions is missing"));
  EXPECT_THAT(refusal(R"({"op":"subscribe","subscriptions":[7]})"), HasSubstr("list of objects"));
  EXPECT_THAT(refusal(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
              HasSubstr("id must be a whole number"));
  EXPECT_THAT(refusal(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})"),
              HasSubstr("no channel 0"));
  EXPECT_THAT(refusal(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":4}]})"),
              HasSubstr("no channel 4"));
  EXPECT_THAT(refusal(R"({"op":"unsubscribe","subscriptionIds":[9]})"),
              HasSubstr("no subscription 9"));
  EXPECT_THAT(refusal(R"({"op":"fetchAsset","uri":7,"requestId":1})"),
              HasSubstr("uri must be a text"));
  EXPECT_EQ(viewer.refused(), 14u);
  EXPECT_EQ(viewer.cut(), "");
  for (unsigned i = 0; i < Viewer::kMaxErrors; ++i)
    viewer.binary(now += std::chrono::milliseconds(10));
  EXPECT_THAT(viewer.cut(), HasSubstr("refused"));
}

/// Randomly damaged messages of a client: none is fatal, and each refusal is answered while the
/// viewer is connected.
TEST_F(ViewerTest, damaged_messages_are_never_fatal) {
  const std::vector<std::string> good{
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":3}]})",
      R"({"op":"unsubscribe","subscriptionIds":[1,2]})",
      R"({"op":"getParameters","parameterNames":["robot"],"id":"x"})",
      R"({"op":"fetchAsset","uri":"package://there","requestId":5})",
      R"({"op":"subscribeConnectionGraph"})"};
  const std::string letters = "{}[]\":,\\0123456789-.eE truefalsn\xff\x80\x01/";
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Viewer one(hub);
    std::uint64_t refused = 0;
    for (int i = 0; i < 60; ++i) {
      std::string message = good[random() % good.size()];
      for (unsigned n = random() % 6; n > 0; --n) {
        const std::size_t at = random() % message.size();
        if (random() % 3 == 0) {
          message.erase(at, random() % 8);
          if (message.empty()) message = "x";
        } else {
          message[at] = letters[random() % letters.size()];
        }
      }
      while (!one.outbox().empty()) one.outbox().pop();
      one.text(message, now += std::chrono::milliseconds(1));
      EXPECT_EQ(one.cut(), "");
      EXPECT_TRUE(one.refused() == refused || !one.outbox().empty()) << message;
      refused = one.refused();
    }
    EXPECT_GT(refused, 0u);
  }
}

TEST_F(ViewerTest, subscriptions_messages_and_answers_are_bounded) {
  skip_greeting();
  Json many = Json::array();
  for (unsigned i = 0; i < 300; ++i) many.push_back({{"id", i}, {"channelId", 1}});
  EXPECT_THAT(refusal(Json{{"op", "subscribe"}, {"subscriptions", many}}.dump()),
              HasSubstr("more than 256"));
  for (int i = 0; i < 1200 && viewer.cut().empty(); ++i)
    say({{"op", "getParameters"}, {"parameterNames", Json::array()}});
  EXPECT_THAT(viewer.cut(), HasSubstr("does not read"));
  Viewer other(hub);
  for (unsigned i = 0; i < Viewer::kMaxMessages + 1; ++i)
    other.text(R"({"op":"unsubscribeConnectionGraph"})", now);
  EXPECT_THAT(other.cut(), HasSubstr("messages in a second"));
}

TEST_F(ViewerTest, answers_with_assets_and_parameters) {
  skip_greeting();
  say({{"op", "fetchAsset"}, {"uri", "package://there"}, {"requestId", 5}});
  const Frame good = viewer.outbox().pop();
  EXPECT_EQ(good.head, (std::vector<std::uint8_t>{4, 5, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(body(good), "mesh");
  say({{"op", "fetchAsset"}, {"uri", "package://elsewhere"}, {"requestId", 6}});
  const Frame bad = viewer.outbox().pop();
  EXPECT_EQ(bad.head[5], 1);
  EXPECT_EQ(std::string(bad.head.begin() + 10, bad.head.end()), "there is no such asset");
  say({{"op", "getParameters"}, {"parameterNames", {"domain"}}, {"id", "q"}});
  EXPECT_EQ(next(), (Json{{"op", "parameterValues"},
                          {"id", "q"},
                          {"parameters", {{{"name", "domain"}, {"value", "5"}}}}}));
}

TEST_F(ViewerTest, learns_what_changed_in_the_graph) {
  skip_greeting();
  hub.set_graph({.writers = {{"a", {"sim"}}, {"b", {"spark"}}}, .readers = {{"a", {"spark"}}}});
  viewer.graph_changed();
  EXPECT_TRUE(viewer.outbox().empty());  // not subscribed
  say({{"op", "subscribeConnectionGraph"}});
  const Json all = next();
  EXPECT_EQ(all["publishedTopics"].size(), 2u);
  EXPECT_EQ(all["subscribedTopics"][0], (Json{{"name", "a"}, {"subscriberIds", {"spark"}}}));
  hub.set_graph({.writers = {{"a", {"sim", "twin"}}}, .readers = {{"a", {"spark"}}}});
  viewer.graph_changed();
  const Json change = next();
  EXPECT_EQ(change["publishedTopics"].size(), 1u);
  EXPECT_TRUE(change["subscribedTopics"].empty());
  EXPECT_EQ(change["removedTopics"], Json{"b"});
}

TEST_F(ViewerTest, tells_the_time) {
  skip_greeting();
  viewer.time(1);
  viewer.time(258);
  EXPECT_EQ(viewer.outbox().pop().head, (std::vector<std::uint8_t>{2, 2, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(viewer.outbox().empty());
}

TEST(Drawing, is_what_a_panel_needs_to_draw_robot_person_and_object) {
  setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
  const auto robot = std::make_shared<RobotModel>(RobotModel::load(robot_description("jido")));
  const ObjectModel mug = ObjectModel::load(object_description("mug"));
  Drawing drawing(robot, [&](const std::string& name) { return name == "mug" ? &mug : nullptr; });
  EXPECT_EQ(drawing.transforms(1), "");
  RobotState state;
  state.position = robot->rest_configuration();
  state.T_world_base.translation() = Vector3(1, 2, 0);
  drawing.take(state);
  HumanState people;
  people.people.resize(1);
  people.people[0].id = "anna";
  people.people[0].joints = standing_body(Vector3(3, 0, 0), M_PI, 1.75);
  drawing.take(people);
  Scene scene;
  scene.objects.push_back({.id = "cup",
                           .model = "mug",
                           .T_world_object = Pose::Identity(),
                           .holder = Holder::nobody,
                           .holder_id = {},
                           .age = 0});
  scene.objects.back().T_world_object.translation() = Vector3(0.5, 0, 0.8);
  drawing.take(scene);

  // The chained transforms give the pose of every link in the model.
  foxglove::FrameTransforms transforms;
  ASSERT_TRUE(transforms.ParseFromString(drawing.transforms(5'000'000'007)));
  ASSERT_EQ(static_cast<std::size_t>(transforms.transforms_size()), robot->links().size());
  EXPECT_EQ(transforms.transforms(0).timestamp().seconds(), 5);
  EXPECT_EQ(transforms.transforms(0).timestamp().nanos(), 7);
  std::map<std::string, Pose> T_world{{"world", Pose::Identity()}};
  for (const auto& t : transforms.transforms()) {
    ASSERT_TRUE(T_world.contains(t.parent_frame_id())) << t.child_frame_id();
    Pose T = Pose::Identity();
    T.translation() = Vector3(t.translation().x(), t.translation().y(), t.translation().z());
    T.linear() =
        Eigen::Quaterniond(t.rotation().w(), t.rotation().x(), t.rotation().y(), t.rotation().z())
            .toRotationMatrix();
    T_world[t.child_frame_id()] = T_world[t.parent_frame_id()] * T;
  }
  std::vector<Pose> T_root_link;
  robot->forward(state.position, T_root_link);
  for (std::size_t i = 0; i < T_root_link.size(); ++i)
    EXPECT_TRUE(T_world[robot->links()[i].name].isApprox(state.T_world_base * T_root_link[i], 1e-9))
        << robot->links()[i].name;

  foxglove::SceneUpdate update;
  ASSERT_TRUE(update.ParseFromString(drawing.scene(1)));
  std::map<std::string, int> primitives;
  for (const auto& entity : update.entities()) {
    EXPECT_TRUE(T_world.contains(entity.frame_id())) << entity.id();
    primitives[entity.id().substr(0, entity.id().find('/'))] +=
        entity.cubes_size() + entity.spheres_size() + entity.cylinders_size();
  }
  EXPECT_GT(primitives["robot"], 20);
  EXPECT_EQ(primitives["person"], 3 * kBodyCapsules);
  EXPECT_EQ(primitives["object"], 10);  // a cylinder and three capsules
  EXPECT_EQ(update.entities(update.entities_size() - 1).cylinders(0).pose().position().x(), 0.5);
}

struct CatalogueTest : testing::Test {
  CatalogueTest() { setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1); }
};

TEST_F(CatalogueTest, has_a_self_contained_schema_for_every_topic) {
  const RobotModel robot = RobotModel::load(robot_description("jido"));
  const Catalogue catalogue = make_catalogue(
      robot, resource_root(), {.scenario = "s", .domain = 3, .version = "1", .session = "x"});
  ASSERT_EQ(catalogue.channels.size(), topics().size());
  for (std::size_t i = 0; i < topics().size(); ++i) {
    const Channel& channel = catalogue.channels[i];
    EXPECT_EQ(channel.schema_name, std::string("handsel::") + topics()[i].type);
    EXPECT_THAT(channel.schema, HasSubstr(std::string("struct ") + topics()[i].type + " {"));
    EXPECT_THAT(channel.schema, testing::Not(HasSubstr("#")));
    for (const char* unreadable :
         {"@optional", "@external", "union ", "wchar", "wstring", "long double"})
      EXPECT_THAT(channel.schema, testing::Not(HasSubstr(unreadable))) << channel.topic;
    EXPECT_EQ(channel.schema.find("struct Vector3 {"), channel.schema.rfind("struct Vector3 {"))
        << channel.topic;
  }
  EXPECT_THAT(catalogue.parameters.at("/robot_description"), HasSubstr("<robot"));
}

TEST_F(CatalogueTest, the_page_learns_where_things_are) {
  const RobotModel robot = RobotModel::load(robot_description("jido"));
  const Json config = Json::parse(config_json(robot, resource_root(),
                                              {.scenario = "give_mug",
                                               .domain = 3,
                                               .version = "1",
                                               .session = "x",
                                               .zones = {0.1, 0.4, 1.2, 3.6},
                                               .attentive_angle = 0.5}));
  EXPECT_EQ(config["zones"], Json({0.1, 0.4, 1.2, 3.6}));
  EXPECT_EQ(config["attentive_angle"], 0.5);
  ASSERT_EQ(config["limits"].size(), robot.axes().size());
  EXPECT_EQ(config["limits"][2]["upper"], robot.axes()[2].upper);
  EXPECT_EQ(config["limits"][2]["jerk"], robot.guard_limits().jerk[2]);
  const Site site({}, resource_root());
  EXPECT_TRUE(site.find(config["urdf"].get<std::string>()));
  EXPECT_EQ(config["axes"].size(), robot.axes().size());
  EXPECT_EQ(config["topics"].size(), topics().size());
  for (const auto& [name, object] : config["objects"].items())
    EXPECT_TRUE(site.find(object["mesh"].get<std::string>())) << name;
  EXPECT_TRUE(config["objects"].contains("mug"));
}

TEST_F(CatalogueTest, an_object_of_the_search_path_has_its_mesh_and_goes_before_the_projects_own) {
  const test::TemporaryFolder folder;
  std::filesystem::copy(resource("objects/mug/mug.obj"), folder.path() / "cup.obj");
  folder.write("mug.txtpb", "name: \"mug\" mesh: \"cup.obj\" mass: 0.2 scale { x: 2 y: 2 z: 2 }");
  folder.write("broken.txtpb", "name: \"broken\" mesh: \"nothing.obj\" mass: 0.2");
  setenv("HANDSEL_PATH", folder.path().c_str(), 1);
  const RobotModel robot = RobotModel::load(robot_description("jido"));
  Site site({}, resource_root());
  for (const OwnMesh& own : own_meshes(resource_root())) site.serve(own.address, own.mesh);
  const Json objects = Json::parse(
      config_json(robot, resource_root(),
                  {.scenario = "s", .domain = 3, .version = "1", .session = "x"}))["objects"];
  unsetenv("HANDSEL_PATH");
  EXPECT_EQ(objects["mug"]["scale"][0], 2.0);
  EXPECT_FALSE(objects.contains("broken"));
  EXPECT_EQ(site.find(objects["mug"]["mesh"].get<std::string>()),
            std::filesystem::canonical(folder.path() / "cup.obj"));
  EXPECT_FALSE(site.find("/assets/own/../cup.obj"));
}

/// For robots put together from several files, or kept elsewhere.
TEST_F(CatalogueTest, a_drawn_robot_stands_as_its_model) {
  const RobotModel robot = RobotModel::load(robot_description("jido"));
  const test::TemporaryFolder folder;
  const RobotModel again = RobotModel::load_urdf(folder.write("drawn.urdf", drawn_urdf(robot)));
  ASSERT_EQ(again.links().size(), robot.links().size());
  ASSERT_EQ(again.dof(), robot.dof());
  Vector q(again.dof());
  for (int i = 0; i < again.dof(); ++i)
    for (int k = 0; k < robot.dof(); ++k)
      if (again.axes()[static_cast<std::size_t>(i)].name ==
          robot.axes()[static_cast<std::size_t>(k)].name)
        q[i] = robot.rest_configuration()[k] + 0.01 * k;
  Vector original(robot.dof());
  for (int k = 0; k < robot.dof(); ++k) original[k] = robot.rest_configuration()[k] + 0.01 * k;
  for (std::size_t l = 0; l < robot.links().size(); ++l) {
    const Pose T = again.link_pose(q, again.link_index(robot.links()[l].name));
    EXPECT_LT((T.matrix() - robot.link_pose(original, static_cast<int>(l)).matrix()).norm(), 1e-5)
        << robot.links()[l].name;
  }
}

TEST_F(CatalogueTest, assets_are_of_robots_and_hands_only) {
  const Site site({}, resource_root());
  const Asset urdf = site.fetch("package://handsel/robots/jido/jido.urdf");
  ASSERT_TRUE(urdf.bytes);
  EXPECT_THAT(std::string(urdf.bytes->begin(), urdf.bytes->end()), HasSubstr("<robot"));
  EXPECT_TRUE(site.fetch("package://handsel/hands/sah/sah.urdf").bytes);
  for (const char* uri :
       {"package://handsel/objects/mug/mug.obj", "package://handsel/config/bridge.txtpb",
        "package://handsel/robots/../config/bridge.txtpb",
        "package://handsel/robots/jido/../../../README.md", "package://other/robots/jido/jido.urdf",
        "file:///etc/passwd", "/etc/passwd", "", "package://handsel/robots/jido/jido.txtpb",
        "package://handsel/robots//jido/jido.urdf"}) {
    const Asset refused = site.fetch(uri);
    EXPECT_FALSE(refused.bytes) << uri;
    EXPECT_FALSE(refused.reason.empty()) << uri;
  }
}

TEST(Subprotocol, is_one_of_two) {
  EXPECT_EQ(choose_subprotocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(choose_subprotocol("x, foxglove.sdk.v1 ,foxglove.websocket.v1"), "foxglove.sdk.v1");
  for (const char* none : {"", ",", "foxglove.websocket.v10", "foxglove"})
    EXPECT_EQ(choose_subprotocol(none), "");
}

TEST(SystemGraph, shows_a_component_until_its_health_stays_away) {
  constexpr std::size_t place = TopicOf<ComponentHealth>::index;
  const std::string topic = TopicOf<ComponentHealth>::row.topic;
  SystemGraph graph;
  const TimePoint start{std::chrono::seconds(100)};
  ComponentHealth health;
  health.component = "spark";
  health.state = HealthState::ok;
  graph.on(health, start);
  health.component = "stranger";
  graph.on(health, start);
  std::vector<bool> read_here(topics().size());
  read_here[place] = true;
  const Graph now = graph.graph(start + std::chrono::seconds(2), read_here);
  EXPECT_THAT(now.writers.at(topic), testing::ElementsAre("spark"));
  EXPECT_THAT(now.readers.at(topic), testing::ElementsAre("bridge"));
  read_here[place] = false;
  const Graph later = graph.graph(start + std::chrono::seconds(3), read_here);
  EXPECT_TRUE(later.writers.at(topic).empty());
  EXPECT_TRUE(later.readers.at(topic).empty());
}

TEST(SystemGraph, drops_a_component_that_stops_only_after_its_last_report) {
  SystemGraph graph;
  const TimePoint start{std::chrono::seconds(100)};
  ComponentHealth health;
  health.component = "spark";
  graph.on(health, start);
  health.state = HealthState::stopping;
  graph.on(health, start + std::chrono::seconds(2));
  const std::vector<bool> read_here(topics().size());
  const std::string topic = TopicOf<ComponentHealth>::row.topic;
  EXPECT_FALSE(graph.graph(start + std::chrono::seconds(2), read_here).writers.at(topic).empty());
  EXPECT_TRUE(graph.graph(start + std::chrono::seconds(4), read_here).writers.at(topic).empty());
}

}  // namespace
}  // namespace handsel::bridge::bridge_viewer_test
