#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/people.hpp"
#include "common/config/resources.hpp"
#include "common/config/robot.pb.h"
#include "common/config/scenario.pb.h"
#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/task.hpp"
#include "tests/support/temporary_folder.hpp"

namespace handsel {
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

TEST(TextProto, ReadsWhatIsWritten) {
  const TemporaryFolder folder;
  config::RobotDescription out;
  load_text_proto(folder.write("r.txtpb", "# a robot\nname: \"r\"\nrest { key: \"a\" value: 0.5 }\n"), out);
  EXPECT_EQ(out.name(), "r");
  EXPECT_EQ(out.rest().at("a"), 0.5);
}

TEST(TextProto, NamesFileLineAndColumnOfWhatIsWrong) {
  EXPECT_THAT(refusal("name: \"r\"\nspeed: 3\n"), HasSubstr("r.txtpb:2:"));
  EXPECT_THAT(refusal("name: \"r\"\nspeed: 3\n"), HasSubstr("speed"));
  EXPECT_THAT(refusal("name: 3\n"), HasSubstr("r.txtpb:1:"));
  EXPECT_THAT(refusal("name: \"a\"\n\nname: \"b\"\n"), HasSubstr("r.txtpb:3:"));
  EXPECT_THAT(refusal("groups { name: \"arm\"\n"), HasSubstr("r.txtpb:"));
}

TEST(TextProto, AUrdfInItsPlaceIsCalledOne) {
  EXPECT_THAT(refusal("<?xml version=\"1.0\"?>\n<robot name=\"r\"/>\n"), HasSubstr("r.txtpb is XML, e.g. a URDF"));
}

TEST(TextProto, AFileThatIsNotThereIsMissing) {
  config::RobotDescription out;
  EXPECT_THAT(message_of<MissingError>([&] { load_text_proto("/nowhere/x.txtpb", out); }), HasSubstr("/nowhere/x.txtpb"));
}

TEST(People, ProfilesAreReadAndThoseThatCannotBeAreRefused) {
  const TemporaryFolder folder;
  EXPECT_EQ(load_people(folder.path()).people_size(), 0);
  const auto refused = [&](const std::string& text) {
    folder.write("people.txtpb", text);
    return message_of<ConfigError>([&] { load_people(folder.path()); });
  };
  folder.write("people.txtpb", "people { id: \"anna\" handed: LEFT height: 1.66 preferred_distance: 0.6 }");
  EXPECT_DOUBLE_EQ(load_people(folder.path()).people(0).height(), 1.66);
  EXPECT_THAT(refused("people { height: 1.7 }"), HasSubstr("a profile needs the person's id"));
  EXPECT_THAT(refused("people { id: \"a\" } people { id: \"a\" }"), HasSubstr("a has two profiles"));
  EXPECT_THAT(refused("people { id: \"a\" height: 17 }"), HasSubstr("height of a must be 0 (as it is seen) or in [0.8, 2.5]"));
  EXPECT_THAT(refused("people { id: \"a\" preferred_distance: -1 }"), HasSubstr("preferred_distance of a must be in [0, 2]"));
}

TEST(Resources, FindsTheDescriptionsOfTheProject) {
  EXPECT_TRUE(std::filesystem::exists(robot_description("jido")));
  EXPECT_TRUE(std::filesystem::exists(hand_description("sah")));
  EXPECT_TRUE(std::filesystem::exists(object_description("mug")));
  EXPECT_TRUE(std::filesystem::exists(resource("robots")));
}

TEST(Resources, ListsWhatThereIsWhenANameIsUnknown) {
  EXPECT_THAT(message_of<MissingError>([] { robot_description("jodi"); }), HasSubstr("jido"));
  EXPECT_THAT(message_of<MissingError>([] { object_description("mugg"); }), HasSubstr("bottle, "));
  EXPECT_THAT(message_of<MissingError>([] { robot_description("./nothing.txtpb"); }), HasSubstr("nothing.txtpb"));
  EXPECT_THAT(message_of<MissingError>([] { resource("robots/none"); }), HasSubstr("robots/none"));
}

TEST(Resources, LocatesTheFirstLineWithAText) {
  const TemporaryFolder folder;
  const auto file = folder.write("x", "one\ntwo \"b\"\nthree \"b\"\n");
  EXPECT_THAT(locate(file, "\"b\""), EndsWith("x:2"));
  EXPECT_THAT(locate(file, "absent"), EndsWith("/x"));
}

TEST(Names, AreThoseOfTheEnumerators) {
  EXPECT_STREQ(name(Mode::hold), "hold");
  EXPECT_STREQ(name(Cause::override_slow), "override_slow");
  EXPECT_STREQ(name(TaskKind::give), "give");
  EXPECT_STREQ(name(TaskState::succeeded), "succeeded");
  EXPECT_STREQ(name(ActionKind::go_to), "go_to");
  EXPECT_STREQ(name(Behaviour::receive), "receive");
  EXPECT_STREQ(name(static_cast<Mode>(200)), "unknown");
}

}  // namespace
}  // namespace handsel
