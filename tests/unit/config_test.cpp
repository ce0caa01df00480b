// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/config/located.hpp"
#include "common/config/people.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/attention.pb.h"
#include "common/config/schema/bridge.pb.h"
#include "common/config/schema/calibration.pb.h"
#include "common/config/schema/collision_checker.pb.h"
#include "common/config/schema/cost.pb.h"
#include "common/config/schema/costmap.pb.h"
#include "common/config/schema/driver.pb.h"
#include "common/config/schema/grasp_planner.pb.h"
#include "common/config/schema/manipulation_planner.pb.h"
#include "common/config/schema/path_planner.pb.h"
#include "common/config/schema/robot.pb.h"
#include "common/config/schema/ros2_lane.pb.h"
#include "common/config/schema/scenario.pb.h"
#include "common/config/schema/sim.pb.h"
#include "common/config/schema/spark.pb.h"
#include "common/config/schema/supervisor.pb.h"
#include "common/config/schema/task_domain.pb.h"
#include "common/config/schema/trajectory_controller.pb.h"
#include "common/config/schema/trajectory_planner.pb.h"
#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/task.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::config_test {
namespace {

using test::message_of;
using test::TemporaryFolder;

using ::testing::EndsWith;
using ::testing::HasSubstr;

std::string refusal(const std::string& text) {
  const TemporaryFolder folder;
  config::RobotDescription out;
  return message_of<ConfigError>([&] { load_text_proto(folder.write("r.txtpb", text), out); });
}

TEST(TextProto, reads_what_is_written) {
  const TemporaryFolder folder;
  config::RobotDescription out;
  load_text_proto(
      folder.write("r.txtpb", "# a robot\nname: \"r\"\nrest { key: \"a\" value: 0.5 }\n"), out);
  EXPECT_EQ(out.name(), "r");
  EXPECT_EQ(out.rest().at("a"), 0.5);
}

TEST(TextProto, names_file_line_and_column_of_what_is_wrong) {
  EXPECT_THAT(refusal("name: \"r\"\nspeed: 3\n"), HasSubstr("r.txtpb:2:"));
  EXPECT_THAT(refusal("name: \"r\"\nspeed: 3\n"), HasSubstr("speed"));
  EXPECT_THAT(refusal("name: 3\n"), HasSubstr("r.txtpb:1:"));
  EXPECT_THAT(refusal("name: \"a\"\n\nname: \"b\"\n"), HasSubstr("r.txtpb:3:"));
  EXPECT_THAT(refusal("groups { name: \"arm\"\n"), HasSubstr("r.txtpb:"));
}

TEST(TextProto, a_urdf_in_its_place_is_called_one) {
  EXPECT_THAT(refusal("<?xml version=\"1.0\"?>\n<robot name=\"r\"/>\n"),
              HasSubstr("r.txtpb is XML, e.g. a URDF"));
}

TEST(TextProto, a_file_that_is_not_there_is_missing) {
  config::RobotDescription out;
  EXPECT_THAT(message_of<MissingError>([&] { load_text_proto("/nowhere/x.txtpb", out); }),
              HasSubstr("/nowhere/x.txtpb"));
}

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

/// Everything that is read from a file in Protobuf text.
std::vector<const Descriptor*> texts() {
  using namespace config;
  return {AttentionSettings::descriptor(),
          BridgeSettings::descriptor(),
          Calibration::descriptor(),
          CollisionCheckerSettings::descriptor(),
          HumanCostSettings::descriptor(),
          CostmapSettings::descriptor(),
          PositionArmSettings::descriptor(),
          ReflexArmSettings::descriptor(),
          GraspPlannerSettings::descriptor(),
          ManipulationPlannerSettings::descriptor(),
          PathPlannerSettings::descriptor(),
          PeopleProfiles::descriptor(),
          RobotDescription::descriptor(),
          HandDescription::descriptor(),
          ObjectDescription::descriptor(),
          Ros2LaneSettings::descriptor(),
          Scenario::descriptor(),
          SimSettings::descriptor(),
          SparkSettings::descriptor(),
          SupervisorSettings::descriptor(),
          TaskDomain::descriptor(),
          TrajectoryControllerSettings::descriptor(),
          TrajectoryPlannerSettings::descriptor()};
}

struct NumericKey {
  const Descriptor* type;
  std::string before, key,
      after;  ///< of a text on two lines that gives the key a value; the key stands on the second
};

/// Adds the keys of the last message of `path`, which leads from a file to a message inside.
void add_numeric_keys(std::vector<const Descriptor*> path, const std::string& before,
                      const std::string& after, std::vector<NumericKey>& out) {
  const Descriptor* type = path.back();
  path.push_back(nullptr);
  for (int i = 0; i < type->field_count(); ++i) {
    const FieldDescriptor& field = *type->field(i);
    if (field.message_type() == path.front()) continue;  // a scenario in a variant of a scenario
    // A wall of a part is a part itself: expanded only once.
    if (std::count(path.begin(), path.end(), field.message_type()) > 1) continue;
    path.back() = field.message_type();
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE)
      add_numeric_keys(path, before + field.name() + " { ", " }" + after, out);
    else if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE)
      out.push_back({path.front(), before, field.name(), after});
    path.back() = nullptr;
  }
}

std::vector<NumericKey> numeric_keys() {
  std::vector<NumericKey> out;
  for (const Descriptor* type : texts()) add_numeric_keys({type}, "# a comment\n", "\n", out);
  return out;
}

TEST(TextProto, every_numeric_key_of_every_file_refuses_nan_inf_and_huge_values) {
  auto* const factory = google::protobuf::MessageFactory::generated_factory();
  const std::vector<NumericKey> keys = numeric_keys();
  EXPECT_GT(keys.size(), 400u);
  for (const NumericKey& key : keys) {
    for (const char* value : {"nan", "-nan", "inf", "-inf", "1e400", "-1e400", "1e300", "-2e6"}) {
      const std::string text = key.before + key.key + ": " + value + key.after;
      const std::unique_ptr<google::protobuf::Message> out(factory->GetPrototype(key.type)->New());
      const std::string message = message_of<ConfigError>([&] {
        google::protobuf::TextFormat::ParseInfoTree places;
        parse_text_proto(text, "s.txtpb", *out, places);
      });
      EXPECT_THAT(message, HasSubstr("s.txtpb:2:" + key.key + ": is ")) << text;
      EXPECT_THAT(message, HasSubstr(", must be a number in ")) << text;
    }
  }
}

TEST(TextProto, a_number_out_of_its_range_is_refused_and_the_range_is_named) {
  const TemporaryFolder folder;
  config::SparkSettings spark;
  EXPECT_THAT(message_of<ConfigError>([&] {
                load_text_proto(
                    folder.write("spark.txtpb", "human_period: 0.05\npublish_period: 0\n"), spark);
              }),
              HasSubstr("spark.txtpb:2:publish_period: is 0, must be a number in (0, 10]"));
  EXPECT_THAT(message_of<ConfigError>([&] {
                load_text_proto(folder.write("spark.txtpb", "stretched: -0.1\n"), spark);
              }),
              HasSubstr("spark.txtpb:1:stretched: is -0.1, must be a number in [0, 2]"));
  config::SupervisorSettings supervisor;
  EXPECT_THAT(message_of<ConfigError>(
                  [&] { load_text_proto(folder.write("s.txtpb", "plan_nodes: 0\n"), supervisor); }),
              HasSubstr("s.txtpb:1:plan_nodes: is 0, must be a number in [1, 1e+06]"));
  EXPECT_THAT(message_of<ConfigError>([&] {
                load_text_proto(folder.write("s.txtpb", "payload { key: \"jido\" value: nan }\n"),
                                supervisor);
              }),
              HasSubstr("s.txtpb:1:value: is nan, must be a number in [0, 1000]"));
  load_text_proto(folder.write("spark.txtpb", "grip_force: -0\n"), spark);  // counts as 0
}

TEST(TextProto, names_that_are_no_text_and_keys_given_twice_are_refused) {
  EXPECT_THAT(refusal("name: \"\\377\\376\"\n"), HasSubstr("r.txtpb:1:name: is no text in UTF-8"));
  EXPECT_THAT(refusal("name: \"a\\000b\"\n"), HasSubstr("r.txtpb:1:name: is no text in UTF-8"));
  EXPECT_THAT(refusal("name: \"" + std::string(5000, 'a') + "\"\n"),
              HasSubstr("is 5000 bytes long, must be at most 4096"));
  EXPECT_THAT(refusal("rest { key: \"a\" value: 1 }\nrest { key: \"a\" value: 2 }\n"),
              HasSubstr("r.txtpb:2:rest: has the key \"a\" twice"));
  EXPECT_EQ(refusal("name: \"Zo\303\253\"\n"), "no error");
  EXPECT_LT(refusal(std::string(1 << 20, 'x') + ": 1\n").size(), 500u);
  EXPECT_THAT(refusal(std::string(5u << 20, ' ')), HasSubstr("r.txtpb has 5 MB; it may have 4 MB"));
}

TEST(People, profiles_are_read_and_those_that_cannot_be_are_refused) {
  const TemporaryFolder folder;
  EXPECT_EQ(load_people(folder.path()).people.size(), 0U);
  const auto refused = [&](const std::string& text) {
    folder.write("people.txtpb", text);
    return message_of<ConfigError>([&] { load_people(folder.path()); });
  };
  folder.write("people.txtpb",
               "people { id: \"anna\" handed: LEFT height: 1.66 preferred_distance: 0.6 }");
  EXPECT_DOUBLE_EQ(load_people(folder.path()).people[0].height, 1.66);
  EXPECT_THAT(refused("people { height: 1.7 }"), HasSubstr("a profile needs the person's id"));
  EXPECT_THAT(refused("people { id: \"a\" } people { id: \"a\" }"),
              HasSubstr("a has two profiles"));
  EXPECT_THAT(refused("people { id: \"a\" height: 17 }"),
              HasSubstr("height: is 17, must be a number in [0, 2.5]"));
  EXPECT_THAT(refused("people { id: \"a\" preferred_distance: -1 }"),
              HasSubstr("preferred_distance: is -1, must be a number in [0, 2]"));
}

TEST(Resources, finds_the_descriptions_of_the_project) {
  EXPECT_TRUE(std::filesystem::exists(robot_description("jido")));
  EXPECT_TRUE(std::filesystem::exists(hand_description("sah")));
  EXPECT_TRUE(std::filesystem::exists(object_description("mug")));
  EXPECT_TRUE(std::filesystem::exists(resource("robots")));
}

TEST(Resources, lists_what_there_is_when_a_name_is_unknown) {
  EXPECT_THAT(message_of<MissingError>([] { robot_description("jodi"); }), HasSubstr("jido"));
  EXPECT_THAT(message_of<MissingError>([] { object_description("mugg"); }), HasSubstr("bottle, "));
  EXPECT_THAT(message_of<MissingError>([] { robot_description("./nothing.txtpb"); }),
              HasSubstr("nothing.txtpb"));
  EXPECT_THAT(message_of<MissingError>([] { resource("robots/none"); }), HasSubstr("robots/none"));
}

TEST(Resources, locates_the_first_line_with_a_text) {
  const TemporaryFolder folder;
  const auto file = folder.write("x", "one\ntwo \"b\"\nthree \"b\"\n");
  EXPECT_THAT(locate(file, "\"b\""), EndsWith("x:2"));
  EXPECT_THAT(locate(file, "absent"), EndsWith("/x"));
}

TEST(Names, are_those_of_the_enumerators) {
  EXPECT_STREQ(name(Mode::hold), "hold");
  EXPECT_STREQ(name(Cause::override_slow), "override_slow");
  EXPECT_STREQ(name(TaskKind::give), "give");
  EXPECT_STREQ(name(TaskState::succeeded), "succeeded");
  EXPECT_STREQ(name(ActionKind::go_to), "go_to");
  EXPECT_STREQ(name(Behaviour::receive), "receive");
  EXPECT_STREQ(name(static_cast<Mode>(200)), "unknown");
}

}  // namespace
}  // namespace handsel::config_test
