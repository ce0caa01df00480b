// SPDX-License-Identifier: Apache-2.0
// User settings over the shipped ones: files, values of the command line, files on the search path.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/base/errors.hpp"
#include "common/config/assignment.hpp"
#include "common/config/overlay.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/attention.pb.h"
#include "common/config/schema/overlay.pb.h"
#include "common/config/settings/spark.hpp"
#include "common/config/settings/trajectory_controller.hpp"
#include "common/config/settings_text.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::overlay_test {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using testing::HasSubstr;

class Overlay : public testing::Test {
 protected:
  ~Overlay() override {
    use_overlays({});
    unsetenv("HANDSEL_PATH");
  }
  static settings::SparkSettings spark() {
    return settings::read_spark_settings(resource("config/spark.txtpb"));
  }
  static config::AttentionSettings attention() {
    config::AttentionSettings out;
    load_text_proto(resource("config/attention.txtpb"), out);
    return out;
  }
  std::string refusal(const std::string& text) {
    return message_of<ConfigError>(
        [&] { use_overlays({.files = {folder.write("my.txtpb", text).string()}}); });
  }
  static std::string refused(const std::string& assignment) {
    return message_of<ConfigError>([&] { use_overlays({.assignments = {assignment}}); });
  }
  test::TemporaryFolder folder;
};

TEST_F(Overlay, has_a_part_for_every_shipped_file) {
  for (const auto& entry : fs::directory_iterator(resource("config")))
    EXPECT_NE(config::SettingsOverlay::descriptor()->FindFieldByName(entry.path().stem()), nullptr)
        << entry.path();
}

TEST_F(Overlay, a_file_changes_what_it_writes_and_nothing_else) {
  const auto before = spark();
  const auto file = folder.write("my.txtpb",
                                 "spark { grip_force: 0 }\n"
                                 "trajectory_controller {\n  view { ceiling: 2.25 } }\n");
  use_overlays({.files = {file.string()}});
  EXPECT_EQ(spark().grip_force, 0);
  EXPECT_NE(before.grip_force, 0);
  EXPECT_EQ(spark().holding_distance, before.holding_distance);
  SettingsText text;
  const auto controller = settings::read_trajectory_controller_settings(
      resource("config/trajectory_controller.txtpb"), &text);
  EXPECT_EQ(controller.view.ceiling, 2.25);
  EXPECT_THAT(text.root().inside("view").of("ceiling"), HasSubstr("my.txtpb:3:ceiling"));
  EXPECT_THAT(text.root().of("period"), HasSubstr("config/trajectory_controller.txtpb"));
}

TEST_F(Overlay, an_assignment_goes_over_a_file_and_a_later_file_over_an_earlier) {
  const auto one = folder.write("one.txtpb", "spark { grip_force: 4 holding_distance: 0.05 }");
  const auto two = folder.write("two.txtpb", "spark { grip_force: 5 }");
  use_overlays({.files = {one.string(), two.string()}});
  EXPECT_EQ(spark().grip_force, 5);
  EXPECT_EQ(spark().holding_distance, 0.05);
  use_overlays({.files = {one.string()}, .assignments = {"spark.grip_force=3"}});
  EXPECT_EQ(spark().grip_force, 3);
  EXPECT_THAT(overlay_arguments(),
              testing::ElementsAre("--config", one.string(), "--set", "spark.grip_force=3"));
}

TEST_F(Overlay, an_entry_of_a_list_is_found_by_its_name_and_a_new_one_added) {
  const auto before = attention();
  const auto file = folder.write("my.txtpb",
                                 "attention { behaviours { name: \"give\" p_min: 0.033 }\n"
                                 "  behaviours { name: \"mine\" p_min: 0.05 p_max: 0.5 far: 2 } }");
  use_overlays(
      {.files = {file.string()}, .assignments = {"attention.behaviours.receive.p_min=0.044"}});
  const auto after = attention();
  ASSERT_EQ(after.behaviours_size(), before.behaviours_size() + 1);
  for (int i = 0; i < before.behaviours_size(); ++i) {
    const std::string& name = before.behaviours(i).name();
    EXPECT_EQ(after.behaviours(i).name(), name);
    EXPECT_EQ(after.behaviours(i).p_min(), name == "give"      ? 0.033
                                           : name == "receive" ? 0.044
                                                               : before.behaviours(i).p_min());
    EXPECT_EQ(after.behaviours(i).p_max(), before.behaviours(i).p_max());
  }
  const auto& mine = after.behaviours(before.behaviours_size());
  EXPECT_EQ(mine.name(), "mine");
  EXPECT_EQ(mine.weber_gain(), before.behaviours(0).weber_gain()) << "the default of the schema";
}

TEST_F(Overlay, files_on_the_search_path_are_overlays_of_their_component) {
  setenv("HANDSEL_PATH", folder.path().c_str(), 1);
  fs::create_directories(folder.path() / "config");
  fs::create_directories(folder.path() / "behaviours");
  folder.write("config/spark.txtpb", "grip_force: 7\n");
  folder.write("behaviours/mine.txtpb",
               "behaviours { name: \"mine\" p_min: 0.05 p_max: 0.5 far: 2 }\n");
  EXPECT_EQ(spark().grip_force, 7);
  const auto settings = attention();
  EXPECT_EQ(settings.behaviours(settings.behaviours_size() - 1).name(), "mine");
  use_overlays({.assignments = {"spark.grip_force=8"}});
  EXPECT_EQ(spark().grip_force, 8);
}

TEST_F(Overlay, what_is_wrong_is_refused_with_source_key_and_cure) {
  EXPECT_THAT(refusal("spark { grip_forc: 1 }"),
              HasSubstr("my.txtpb:1:grip_forc: is no key of SparkSettings; the nearest is "
                        "\"grip_force\""));
  EXPECT_THAT(refusal("\nsprak { }"), HasSubstr("my.txtpb:2:sprak: is no key of SettingsOverlay; "
                                                "the nearest is \"spark\""));
  EXPECT_THAT(refusal("spark {\n grip_force: -3 }"),
              HasSubstr("my.txtpb:2:grip_force: is -3, must be a number in "));
  EXPECT_THAT(refusal("spark { grip_force: \"much\" }"), HasSubstr("my.txtpb:1:grip_force: "));
  EXPECT_THAT(refused("spark"), HasSubstr("--set spark: must be component.key=value"));
  EXPECT_THAT(refused("sprak.grip_force=1"),
              HasSubstr("no component \"sprak\" has settings; the nearest: spark"));
  EXPECT_THAT(refused("spark.grip_forc=1"),
              HasSubstr("no key \"grip_forc\" is there; the nearest: grip_force"));
  EXPECT_THAT(refused("spark.grip_force=much"), HasSubstr("is \"much\", must be a number in ["));
  EXPECT_THAT(refused("spark.grip_force=-1"), HasSubstr("is \"-1\", must be a number in ["));
  EXPECT_THAT(refused("spark.grip_force=nan"), HasSubstr("is \"nan\", must be a number in ["));
  EXPECT_THAT(refused("spark.grip_force=1 spare: 2"), HasSubstr("must be a number in ["));
  EXPECT_THAT(refused("attention.off=maybe"), HasSubstr("must be true or false"));
  EXPECT_THAT(refused("attention.behaviours.give.law=SQUARE"), HasSubstr("one of LINEAR, WEBER"));
  EXPECT_THAT(refused("trajectory_controller.walls.a.nx=1"),
              HasSubstr("is a list without names; give the whole list in a file"));
  EXPECT_THAT(refused("attention.behaviours=1"), HasSubstr("has keys of its own: name, "));
  EXPECT_THAT(message_of<MissingError>([] { use_overlays({.files = {"/nowhere.txtpb"}}); }),
              HasSubstr("file /nowhere.txtpb does not exist"));
}

TEST_F(Overlay, values_that_disagree_are_refused_with_the_place_in_the_overlay) {
  use_overlays({.assignments = {"trajectory_controller.period=0.002"}});
  SettingsText text;
  settings::read_trajectory_controller_settings(resource("config/trajectory_controller.txtpb"),
                                                &text);
  EXPECT_THAT(message_of<ConfigError>([&] { text.refuse("period", "disagrees"); }),
              HasSubstr("--set trajectory_controller.period=0.002:period: disagrees"));
}

}  // namespace
}  // namespace handsel::overlay_test
