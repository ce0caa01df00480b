// SPDX-License-Identifier: Apache-2.0
// What the page may command, who may, and where commands wait.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.hpp"
#include "components/bridge/commands/command.hpp"
#include "components/bridge/commands/command_gate.hpp"
#include "components/bridge/commands/command_queue.hpp"

namespace handsel::bridge::bridge_command_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Verdict = CommandGate::Verdict;

TaskGoal task(std::string_view json) {
  const CommandReading reading = read_command(json);
  EXPECT_EQ(reading.refusal, "") << json;
  return reading.command ? std::get<TaskGoal>(*reading.command) : TaskGoal{};
}

SimControl person(std::string_view json) {
  const CommandReading reading = read_command(json);
  EXPECT_EQ(reading.refusal, "") << json;
  return reading.command ? std::get<SimControl>(*reading.command) : SimControl{};
}

std::string refusal(std::string_view json) {
  const CommandReading reading = read_command(json);
  EXPECT_FALSE(reading.command) << json;
  EXPECT_NE(reading.refusal, "") << json;
  return reading.refusal;
}

TEST(BridgeCommand, tasks_and_requests_are_read_with_the_fields_of_their_kind) {
  const TaskGoal give = task(R"({"task":"give","object":"mug","human":"anna"})");
  EXPECT_EQ(give.kind, TaskKind::give);
  EXPECT_EQ(give.object, "mug");
  EXPECT_EQ(give.human, "anna");
  EXPECT_EQ(give.id, 0u);
  EXPECT_EQ(task(R"({"task":"receive"})").kind, TaskKind::receive);
  EXPECT_EQ(task(R"({"task":"receive","onto":"table"})").onto, "table");
  EXPECT_EQ(task(R"({"task":"place","object":"mug","surface":"table"})").surface, "table");
  EXPECT_EQ(task(R"({"task":"go_to","surface":"rest"})").kind, TaskKind::go_to);
  EXPECT_EQ(task(R"({"task":"pause"})").kind, TaskKind::pause);
  EXPECT_EQ(task(R"({"task":"resume"})").kind, TaskKind::resume);
  EXPECT_EQ(task(R"({"task":"cancel"})").kind, TaskKind::cancel);
  EXPECT_DOUBLE_EQ(task(R"({"task":"speed","value":0.5})").value, 0.5);
}

TEST(BridgeCommand, actions_of_simulated_people_are_read) {
  const SimControl hand =
      person(R"({"person":"anna","action":"hand","side":"left","point":[0.7,-0.2,1.1]})");
  EXPECT_EQ(hand.action, SimAction::person_hand);
  EXPECT_EQ(hand.subject, "anna");
  EXPECT_EQ(hand.side, Side::left);
  EXPECT_EQ(hand.point, Vector3(0.7, -0.2, 1.1));
  EXPECT_DOUBLE_EQ(hand.value, 0.5);
  EXPECT_DOUBLE_EQ(
      person(R"({"person":"a","action":"hand","side":"right","point":[0,0,0],"time":0})").value,
      0.0);
  EXPECT_DOUBLE_EQ(person(R"({"person":"anna","action":"dart","speed":2})").value, 2.0);
  EXPECT_DOUBLE_EQ(person(R"({"person":"anna","action":"look_away"})").value, 2.0);
  EXPECT_EQ(person(R"({"person":"anna","action":"leave"})").action, SimAction::person_leave);
  EXPECT_EQ(person(R"({"person":"anna","action":"refuse"})").action, SimAction::person_refuse);
  EXPECT_EQ(person(R"({"person":"anna","action":"freeze"})").action, SimAction::person_freeze);
  EXPECT_EQ(person(R"({"person":"anna","action":"unfreeze"})").action, SimAction::person_unfreeze);
}

TEST(BridgeCommand, what_is_malformed_or_out_of_range_is_refused_in_one_sentence) {
  for (const char* json :
       {"", "{", "[]", "null", "7", "\"give\"", "{}", R"({"task":"give","person":"anna"})"})
    EXPECT_THAT(refusal(json), HasSubstr("a command must")) << json;
  EXPECT_THAT(refusal(R"({"task":"give"})"), HasSubstr("\"object\" is missing"));
  EXPECT_THAT(refusal(R"({"task":"give","object":7})"), HasSubstr("must be a text"));
  EXPECT_THAT(refusal(R"({"task":"give","object":""})"), HasSubstr("printable"));
  EXPECT_THAT(refusal(R"({"task":"give","object":"a\nb"})"), HasSubstr("printable"));
  EXPECT_THAT(refusal(R"({"task":"give","object":")" + std::string(65, 'a') + R"("})"),
              HasSubstr("1 to 64"));
  EXPECT_THAT(refusal(R"({"task":"give","object":"mug","onto":"table"})"),
              HasSubstr("\"onto\" is no field"));
  EXPECT_THAT(refusal(R"({"task":"pause","value":1})"), HasSubstr("\"value\" is no field"));
  EXPECT_THAT(refusal(R"({"task":"speed","value":1.1})"), HasSubstr("from 0 to 1"));
  EXPECT_THAT(refusal(R"({"task":"speed","value":"1"})"), HasSubstr("from 0 to 1"));
  EXPECT_THAT(refusal(R"({"task":"speed","value":1e999})"), HasSubstr("must be a JSON object"));
  EXPECT_THAT(refusal(R"({"person":"anna"})"), HasSubstr("\"action\" is missing"));
  EXPECT_THAT(refusal(R"({"person":"anna","action":"hand","side":"up","point":[0,0,0]})"),
              HasSubstr("left or right"));
  for (const char* point : {"[0,0]", "[0,0,0,0]", "{}", "7"})
    EXPECT_THAT(refusal(R"({"person":"anna","action":"hand","side":"left","point":)" +
                        std::string(point) + "}"),
                HasSubstr("three numbers"))
        << point;
  for (const char* point : {"[0,0,101]", "[0,null,0]", "[\"0\",0,0]", "[-1e300,0,0]"})
    EXPECT_THAT(refusal(R"({"person":"anna","action":"hand","side":"left","point":)" +
                        std::string(point) + "}"),
                HasSubstr("from -100 to 100"))
        << point;
  EXPECT_THAT(refusal(R"({"person":"anna","action":"dart","speed":9})"), HasSubstr("0.1 to 3"));
}

TEST(BridgeCommand, what_concerns_a_real_robot_or_its_sensors_is_no_command_of_the_page) {
  for (const char* kind : {"acknowledge", "clear_person", "drive", "give "})
    EXPECT_THAT(refusal(R"({"task":")" + std::string(kind) + R"("})"),
                testing::AnyOf(HasSubstr("is no task of the page"), HasSubstr("without spaces")));
  for (const char* action : {"robot_stop", "robot_enable", "emergency_stop", "silence_human",
                             "human_frozen", "reset", "person_dart"})
    EXPECT_THAT(refusal(R"({"person":"anna","action":")" + std::string(action) + R"("})"),
                HasSubstr("is no action of a simulated person"));
}

struct BridgeGate : testing::Test {
  static constexpr const char* kToken = "0123456789abcdef0123456789abcdef";
  CommandGate gate{kToken};
  TimePoint now{std::chrono::seconds(10)};

  CommandGate::Answer ask(const std::string& authorization, const std::string& origin = {}) {
    return gate.admit({.authorization = authorization, .origin = origin, .host = "127.0.0.1:8765"},
                      now);
  }
};

TEST_F(BridgeGate, only_the_right_token_admits) {
  EXPECT_EQ(ask("Bearer " + std::string(kToken)).verdict, Verdict::admitted);
  EXPECT_EQ(ask("").verdict, Verdict::no_token);
  EXPECT_EQ(ask(kToken).verdict, Verdict::no_token);
  EXPECT_EQ(ask("Basic " + std::string(kToken)).verdict, Verdict::no_token);
  for (const std::string& wrong :
       {std::string(), std::string("0"), std::string(kToken).substr(1), std::string(kToken) + "0",
        std::string(kToken) + kToken, "1" + std::string(kToken).substr(1),
        std::string(kToken).substr(0, 31) + "e", std::string(32, '\0')}) {
    const CommandGate::Answer answer = ask("Bearer " + wrong);
    EXPECT_EQ(answer.verdict, Verdict::wrong_token) << wrong;
    EXPECT_THAT(answer.refusal, Not(HasSubstr(kToken)));
  }
}

TEST_F(BridgeGate, without_a_token_nobody_is_admitted) {
  CommandGate closed("");
  for (const char* authorization : {"", "Bearer ", "Bearer x"})
    EXPECT_EQ(closed.admit({.authorization = authorization, .origin = {}, .host = {}}, now).verdict,
              Verdict::closed);
}

TEST_F(BridgeGate, only_its_own_page_may_command) {
  const std::string right = "Bearer " + std::string(kToken);
  EXPECT_EQ(ask(right, "http://127.0.0.1:8765").verdict, Verdict::admitted);
  for (const char* origin : {"http://127.0.0.1:80", "http://localhost:8765",
                             "https://127.0.0.1:8765", "https://example.org", "null"})
    EXPECT_EQ(ask(right, origin).verdict, Verdict::foreign) << origin;
}

TEST_F(BridgeGate, more_than_sixty_commands_in_a_second_are_too_many) {
  const std::string right = "Bearer " + std::string(kToken);
  for (unsigned i = 0; i < CommandGate::kMaxPerSecond; ++i)
    EXPECT_EQ(ask(right).verdict, Verdict::admitted) << i;
  EXPECT_EQ(ask("Bearer wrong").verdict, Verdict::wrong_token);
  EXPECT_EQ(ask(right).verdict, Verdict::too_many);
  now += std::chrono::milliseconds(1100);
  EXPECT_EQ(ask(right).verdict, Verdict::admitted);
}

TEST(BridgeToken, short_or_strange_tokens_are_refused_without_being_shown) {
  check_token("");
  check_token("0123456789abcdef");
  for (const std::string& bad :
       {std::string("short"), std::string(129, 'a'), std::string("0123456789 abcdef"),
        std::string("0123456789abcdef\n")}) {
    try {
      check_token(bad);
      FAIL() << bad;
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.what(), Not(HasSubstr(bad)));
    }
  }
}

TEST(BridgeQueue, refuses_what_nobody_takes_and_numbers_tasks) {
  CommandQueue queue(2);
  EXPECT_EQ(queue.put(TaskGoal{}).outcome, CommandQueue::Outcome::nobody_takes_it);
  EXPECT_THAT(queue.put(SimControl{}).refusal, HasSubstr("the simulator is not there"));
  queue.set_takers({.supervisor = true, .simulator = false});
  EXPECT_EQ(queue.put(TaskGoal{}).task, 2u);
  EXPECT_EQ(queue.put(TaskGoal{}).task, 258u);
  EXPECT_EQ(queue.put(SimControl{}).outcome, CommandQueue::Outcome::nobody_takes_it);
  const std::vector<Command> taken = queue.take();
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(std::get<TaskGoal>(taken[1]).id, 258u);
  EXPECT_TRUE(queue.take().empty());
}

TEST(BridgeQueue, holds_a_bounded_number_of_commands) {
  CommandQueue queue(2);
  queue.set_takers({.supervisor = false, .simulator = true});
  for (std::size_t i = 0; i < CommandQueue::kMaxWaiting; ++i)
    EXPECT_EQ(queue.put(SimControl{}).outcome, CommandQueue::Outcome::accepted);
  EXPECT_EQ(queue.put(SimControl{}).outcome, CommandQueue::Outcome::too_many);
  queue.take();
  EXPECT_EQ(queue.put(SimControl{}).outcome, CommandQueue::Outcome::accepted);
}

}  // namespace
}  // namespace handsel::bridge::bridge_command_test
