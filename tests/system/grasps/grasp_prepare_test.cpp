// SPDX-License-Identifier: Apache-2.0
// `handsel grasp prepare`: grasp lists are computed once, kept on disk and read from then on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/support/processes/shell.hpp"

namespace handsel::test::grasp_prepare_test {
namespace {

using Files = std::map<std::string, std::filesystem::file_time_type>;

class GraspPrepare : public testing::Test {
 protected:
  GraspPrepare() {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "cans.txtpb")
        << "name: \"cans\" objects { id: \"a\" model: \"can\" } objects { id: \"b\" model: "
           "\"can\" } tasks { kind: \"give\" object: \"a\" }";
  }
  ~GraspPrepare() override { std::filesystem::remove_all(folder_); }

  Outcome prepare(const std::string& scenario) const { return prepare_in(folder_, scenario); }
  static Outcome prepare_in(const std::filesystem::path& cache, const std::string& scenario) {
    return shell("XDG_CACHE_HOME=" + cache.string() + " " HANDSEL_COMMAND " grasp prepare " +
                 scenario);
  }
  /// Returns the lists on disk with the times at which they were written.
  Files lists() const {
    Files out;
    const std::filesystem::path cache = folder_ / "handsel";
    if (!std::filesystem::exists(cache)) return out;
    for (const auto& file : std::filesystem::directory_iterator(cache))
      out[file.path().filename()] = file.last_write_time();
    return out;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("handsel-prepare-" + std::to_string(getpid()));
};

/// Returns hand, object and number of grasps of each printed line, without the times.
std::vector<std::string> without_times(const std::string& printed) {
  std::vector<std::string> out;
  std::istringstream lines(printed);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string hand, object, grasps;
    words >> hand >> object >> grasps;
    out.push_back(hand + " " + object + " " + grasps);
  }
  return out;
}

TEST_F(GraspPrepare, lists_are_computed_once_and_read_from_then_on) {
  const std::string scenario = (folder_ / "cans.txtpb").string();
  const Outcome first = prepare(scenario);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const auto printed = without_times(first.out);
  ASSERT_EQ(printed.size(), 4u) << first.out;
  EXPECT_EQ(printed[0], "hand object grasps");
  EXPECT_THAT(printed[1], testing::StartsWith("sah can "));
  EXPECT_THAT(printed[2], testing::StartsWith("human_right can "));
  EXPECT_THAT(printed[3], testing::StartsWith("human_left can "));
  for (std::size_t i = 1; i < printed.size(); ++i)
    EXPECT_GT(std::stoi(printed[i].substr(printed[i].rfind(' '))), 0) << printed[i];
  const Files written = lists();
  EXPECT_EQ(written.size(), 3u);

  const Outcome second = prepare(scenario);
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(without_times(second.out), printed);
  EXPECT_EQ(lists(), written) << "a list on disk was computed again";
}

TEST_F(GraspPrepare, a_scenario_that_is_not_there_is_named) {
  const Outcome outcome = prepare("nowhere");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, testing::HasSubstr("nowhere"));
  EXPECT_TRUE(lists().empty());
}

TEST_F(GraspPrepare, what_prevents_lists_from_being_kept_is_said) {
  const std::string scenario = (folder_ / "cans.txtpb").string();
  const Outcome outcome = prepare_in(scenario, scenario);  // a file is no folder
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, testing::HasSubstr("cannot be written to"));
  EXPECT_EQ(outcome.out, "");
  std::ofstream(folder_ / "empty.txtpb") << "name: \"empty\"";
  const Outcome empty = prepare((folder_ / "empty.txtpb").string());
  EXPECT_NE(empty.exit_code, 0);
  EXPECT_THAT(empty.err, testing::HasSubstr("objects: none is given"));
}

}  // namespace
}  // namespace handsel::test::grasp_prepare_test
