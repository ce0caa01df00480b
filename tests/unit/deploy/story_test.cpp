// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/story/story.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.hpp"

namespace handsel::story_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string error_of(const std::string& text) {
  try {
    parse_story(text, "f");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Story, every_line_becomes_a_step) {
  const Story story = parse_story(
      "# a comment\n"
      "start give_mug seed 3\n"
      "wait ready within 10s\n"
      "\n"
      "task give mug to anna\n"
      "at 1.2s kill -9 path_planner   # in the middle\n"
      "expect mode hold within 350ms\n"
      "expect status names path_planner within 1s\n"
      "never mode stop for 2s\n"
      "expect no limit violations\n"
      "speed 30\n"
      "stop\n",
      "f");
  ASSERT_EQ(story.steps.size(), 10u);
  EXPECT_THAT(story.steps[0].words, ElementsAre("give_mug", "seed", "3"));
  EXPECT_EQ(story.steps[1].kind, StepKind::wait);
  EXPECT_EQ(story.steps[1].limit, std::chrono::seconds(10));
  EXPECT_THAT(story.steps[2].words, ElementsAre("give", "mug", "to", "anna"));
  EXPECT_EQ(story.steps[3].at, std::chrono::milliseconds(1200));
  EXPECT_THAT(story.steps[3].words, ElementsAre("-9", "path_planner"));
  EXPECT_EQ(story.steps[3].text, "at 1.2s kill -9 path_planner");
  EXPECT_EQ(story.steps[4].condition->kind, ConditionKind::mode);
  EXPECT_EQ(story.steps[4].condition->subject, "hold");
  EXPECT_EQ(story.steps[4].limit, std::chrono::milliseconds(350));
  EXPECT_EQ(story.steps[5].condition->kind, ConditionKind::status_names);
  EXPECT_EQ(story.steps[6].kind, StepKind::never);
  EXPECT_EQ(story.steps[7].condition->kind, ConditionKind::no_limit_violations);
  EXPECT_EQ(story.steps[7].limit, Duration::zero());
  EXPECT_THAT(story.steps[8].words, ElementsAre("speed", "30"));
  EXPECT_EQ(story.steps[9].line, 12);
}

TEST(Story, a_mistake_is_named_with_its_line) {
  EXPECT_THAT(error_of(""), HasSubstr("no step"));
  EXPECT_THAT(error_of("task give mug\n"), HasSubstr("f:1: a story begins with start"));
  EXPECT_THAT(error_of("start a\ntask give mug anna\n"),
              HasSubstr("f:2: \"anna\" is not understood here; to PERSON"));
  EXPECT_THAT(error_of("start a\ntask give mug to\n"), HasSubstr("should follow \"to\""));
  EXPECT_THAT(error_of("start a\nstart b\n"), HasSubstr("f:2: a story starts once"));
  EXPECT_THAT(error_of("start a\nexpct ready\n"), HasSubstr("f:2: \"expct\" is no step"));
  EXPECT_THAT(error_of("start a\nexpect happiness within 1s\n"),
              HasSubstr("\"happiness\" is no condition"));
  EXPECT_THAT(error_of("start a\nexpect mode\n"), HasSubstr("a name should follow"));
  EXPECT_THAT(error_of("start a\nwait ready\n"), HasSubstr("within"));
  EXPECT_THAT(error_of("start a\nexpect ready within soon\n"), HasSubstr("needs a time"));
  EXPECT_THAT(error_of("start a\nexpect speed below much within 1s\n"),
              HasSubstr("needs a number"));
  EXPECT_THAT(error_of("start a\nspeed nan\n"), HasSubstr("f:2: \"speed\" needs a number"));
  EXPECT_THAT(error_of("start a\nexpect speed below inf within 1s\n"), HasSubstr("needs a number"));
  EXPECT_LT(error_of("start a\n" + std::string(1 << 20, 'x') + "\n").size(), 1000u);
  EXPECT_THAT(error_of("start a\nkill\n"), HasSubstr("a process should follow"));
  EXPECT_THAT(error_of("start a\nstop now\n"), HasSubstr("\"now\" is one word too many"));
  EXPECT_THAT(error_of("start a\nnever ready\n"), HasSubstr("\"for\" should follow"));
}

TEST(Story, times_are_seconds_or_milliseconds) {
  EXPECT_EQ(parse_duration("350ms"), std::chrono::milliseconds(350));
  EXPECT_EQ(parse_duration("1.5s"), std::chrono::milliseconds(1500));
  for (const char* wrong : {"", "s", "ms", "5", "-1s", "1e9s", "nans", "1.2m", "1s2"})
    EXPECT_FALSE(parse_duration(wrong)) << wrong;
}

}  // namespace
}  // namespace handsel::story_test
