// SPDX-License-Identifier: Apache-2.0
// Searches names in the folders of the user before those of the project.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/base/errors.hpp"
#include "common/config/nearest_name.hpp"
#include "common/config/resources.hpp"
#include "common/config/search_path.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::search_path_test {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using testing::ElementsAre;
using testing::HasSubstr;

/// Two folders on the search path and a working directory.
class SearchPath : public testing::Test {
 protected:
  SearchPath() : before_(fs::current_path()) {
    unsetenv("HANDSEL_PATH");
    fs::current_path(working.path());
  }
  ~SearchPath() override {
    fs::current_path(before_);
    unsetenv("HANDSEL_PATH");
  }
  static fs::path write(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return fs::canonical(file);
  }

  test::TemporaryFolder first, second, working;

 private:
  fs::path before_;
};

TEST_F(SearchPath, is_that_of_options_then_of_the_variable_then_here_then_the_project) {
  setenv("HANDSEL_PATH", second.path().c_str(), 1);
  search_first({first.path().string()});
  EXPECT_THAT(search_folders(),
              ElementsAre(fs::canonical(first.path()), fs::canonical(second.path()),
                          fs::canonical(working.path()), resource_root()));
}

TEST_F(SearchPath, the_first_folder_that_has_a_name_wins) {
  const auto shipped = object_description("mug");
  const auto here = write(working.path() / "objects/mug/mug.txtpb", "name: \"mug\"");
  EXPECT_EQ(object_description("mug"), here);
  const auto there = write(second.path() / "objects/mug.txtpb", "name: \"mug\"");
  setenv("HANDSEL_PATH", second.path().c_str(), 1);
  EXPECT_EQ(object_description("mug"), there);
  search_first({first.path().string()});
  EXPECT_EQ(object_description("mug"), there);
  const auto ahead = write(first.path() / "mug.txtpb", "name: \"mug\"");
  EXPECT_EQ(object_description("mug"), ahead);
  EXPECT_EQ(shipped.parent_path().parent_path(), resource_root() / "objects");
}

TEST_F(SearchPath, every_kind_is_found_in_its_folder_or_loose) {
  const auto robot = write(working.path() / "robots/arm/arm.txtpb", "name: \"arm\"");
  const auto hand = write(working.path() / "claw/claw.txtpb", "name: \"claw\"");
  const auto scenario = write(working.path() / "my.scenario", "name: \"my\"");
  const auto story = write(working.path() / "stories/mine.story", "start give_mug\n");
  EXPECT_EQ(robot_description("arm"), robot);
  EXPECT_EQ(hand_description("claw"), hand);
  EXPECT_EQ(fs::canonical(scenario_file("my.scenario")), scenario);
  EXPECT_EQ(find_file(FileKind::story, "mine"), story);
  EXPECT_TRUE(fs::exists(find_file(FileKind::story, "give_mug")));
}

TEST_F(SearchPath, a_loose_file_of_another_kind_is_passed_over) {
  write(working.path() / "mug.txtpb", "tasks { kind: \"give\" object: \"mug\" }");  // a scenario
  EXPECT_EQ(object_description("mug").parent_path().parent_path(), resource_root() / "objects");
  EXPECT_EQ(scenario_file("mug"), fs::canonical(working.path()) / "mug.txtpb");
}

TEST_F(SearchPath, a_name_that_nobody_has_is_answered_with_the_nearest_and_the_folders) {
  write(working.path() / "scenarios/give_cup.txtpb", "name: \"give_cup\"");
  const std::string sentence = message_of<MissingError>([] { scenario_file("give_cpu"); });
  EXPECT_THAT(sentence, HasSubstr("no scenario \"give_cpu\"; there is: "));
  EXPECT_THAT(sentence, HasSubstr("; the nearest: give_cup"));
  EXPECT_THAT(sentence, HasSubstr("searched in " + fs::canonical(working.path()).string() + ", "));
  EXPECT_THAT(message_of<MissingError>([] { search_first({"nowhere"}); }),
              HasSubstr("--path nowhere: no such folder"));
  setenv("HANDSEL_PATH", "/nowhere", 1);
  EXPECT_THAT(message_of<MissingError>([] { object_description("mug"); }),
              HasSubstr("HANDSEL_PATH names /nowhere, which is no folder"));
}

TEST(NearestNames, are_those_with_few_other_letters_or_the_same_begin) {
  const std::vector<std::string> names{"mug", "full_mug", "bottle", "mugs", "ball"};
  EXPECT_THAT(nearest_names("mgu", names), ElementsAre("mug")) << "two letters exchanged";
  EXPECT_THAT(nearest_names("cup", names), ElementsAre());
  EXPECT_THAT(nearest_names("mugg", names), ElementsAre("mug", "mugs"));
  EXPECT_THAT(nearest_names("bot", names), ElementsAre("bottle"));
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

}  // namespace
}  // namespace handsel::search_path_test
