// SPDX-License-Identifier: Apache-2.0
// The table of `handsel eval`: each trial counts once in each of its groups.
#include "deploy/handsel/eval/tally.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace handsel::tally_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

Json line(const std::string& object, bool success, const Json& person) {
  Json out{{"scenario", "s"},
           {"success", success},
           {"drops", success ? 0 : 1},
           {"ssm_violations", 0},
           {"drawn", {{"object", object}, {"person", person}, {"table_top_m", 0.7}}}};
  if (!success) out.update({{"failure", "dropped"}, {"reason", "it slipped"}});
  return out;
}

std::string row_of(const std::string& text, const std::string& under, const std::string& name) {
  const std::size_t table = text.find("s by " + under);
  const std::size_t at = text.find("\n" + name + " ", table);
  return at == std::string::npos ? "" : text.substr(at + 1, text.find('\n', at + 1) - at - 1);
}

TrialTable filled() {
  TrialTable table;
  for (int i = 0; i < 9; ++i) table.add(line("mug", true, {"standing"}));
  table.add(line("mug", false, {"seated", "hesitates"}));
  for (int i = 0; i < 10; ++i) table.add(line("can", true, {"standing", "hesitates"}));
  return table;
}

TEST(TrialTable, groups_by_what_was_drawn_with_intervals_drops_and_reasons) {
  const std::string text = filled().text({});
  EXPECT_THAT(text, HasSubstr("95.0 %    76.4 …  99.1 %"));  // Wilson (1927), 19 of 20
  EXPECT_THAT(row_of(text, "object", "mug"), HasSubstr("10   90.0 %    59.6 …  98.2 %"));
  EXPECT_THAT(row_of(text, "object", "mug"), HasSubstr(" 1           0"));
  EXPECT_THAT(row_of(text, "object", "can"), HasSubstr("10  100.0 %    72.2 … 100.0 %"));
  EXPECT_THAT(row_of(text, "person", "hesitates"), HasSubstr("11   90.9 %"));
  EXPECT_THAT(row_of(text, "person", "seated"), HasSubstr("1    0.0 %"));
  EXPECT_THAT(text.substr(text.find("s by object")), HasSubstr("1 dropped: it slipped"));
  EXPECT_THAT(text, Not(HasSubstr("table_top_m"))) << "a number is no group";
}

TEST(TrialTable, shows_the_headings_that_were_asked_for) {
  EXPECT_EQ(filled().headings(), (std::vector<std::string>{"object", "person"}));
  const std::string text = filled().text({"object"});
  EXPECT_THAT(text, HasSubstr("s by object"));
  EXPECT_THAT(text, Not(HasSubstr("s by person")));
}

TEST(TrialTable, counts_trials_without_draws_and_lines_of_crashes) {
  TrialTable table;
  table.add({{"scenario", "s"}, {"success", false}, {"failure", "crash"}, {"reason", "Killed"}});
  table.add({{"scenario", "s"}, {"success", true}, {"ssm_violations", 3}});
  const std::string text = table.text({});
  EXPECT_THAT(text, HasSubstr("s                              2   50.0 %"));
  EXPECT_THAT(text, HasSubstr("crash: Killed"));
  EXPECT_THAT(text, HasSubstr(" 0           1\n"));
  EXPECT_THAT(text, Not(HasSubstr("s by")));
}

}  // namespace
}  // namespace handsel::tally_test
