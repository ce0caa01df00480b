// SPDX-License-Identifier: Apache-2.0
// The command from the user's side: exit codes, one sentence for each mistake, no remaining
// process.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "deploy/handsel/system/processes.hpp"
#include "tests/support/processes/background.hpp"
#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/websocket_client.hpp"

namespace handsel::test::command_test {
namespace {

using testing::HasSubstr;

const std::string kHandsel = HANDSEL_COMMAND;
const std::string kDomain = " --domain 208";

int processes_running() {
  return std::atoi(shell("ps -eo args | grep -c '[b]in/handsel_.*--domain 208'").out.c_str());
}

/// One sentence, exit code, nothing left.
void expect_refusal(const std::string& arguments, int exit_code, const std::string& says) {
  SCOPED_TRACE(arguments);
  const Outcome outcome = shell(kHandsel + " " + arguments);
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(says));
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_EQ(processes_running(), 0);
}

struct TemporaryFile {
  explicit TemporaryFile(const std::string& text) { std::ofstream(path) << text; }
  ~TemporaryFile() { std::filesystem::remove(path); }
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               ("handsel-test-" + std::to_string(getpid()) + ".txtpb");
};

TEST(Command, wrong_usage_is_one_sentence) {
  expect_refusal("", 2, "subcommand");
  expect_refusal("dance", 2, "dance");
  expect_refusal("task dance mug", 2, "dance");
  expect_refusal("run --scenario give_mug --sed 3", 2, "--sed");
  expect_refusal("up --domain 300", 2, "300");
  expect_refusal("task give", 2, "object");
  expect_refusal("speed 120", 2, "120");
  expect_refusal("topic hz nonsense" + kDomain, 2, "nonsense");
}

TEST(Command, help_is_an_answer) {
  for (const char* command : {"", "up", "run", "task", "task give", "story", "speed", "status",
                              "topic", "topic hz", "doctor", "eval"}) {
    const Outcome outcome = shell(kHandsel + " " + command + " --help");
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_THAT(outcome.out, HasSubstr("--help")) << command;
  }
}

TEST(Command, what_is_not_there_is_named_before_anything_starts) {
  expect_refusal("run --scenario nowhere" + kDomain, 3, "nowhere");
  for (const std::string command : {"run", "up", "eval --trials 1"})
    expect_refusal(command + " nowhere" + (command[0] == 'e' ? "" : kDomain), 3, "nowhere");
  expect_refusal("up --robot nobody" + kDomain, 3, "nobody");
  expect_refusal("story nothing.story", 3, "nothing.story");
  const TemporaryFile scenario(
      "name: \"x\" objects { id: \"a\" model: \"unknown_thing\" } tasks { kind: \"give\" object: "
      "\"a\" }");
  expect_refusal("run --scenario " + scenario.path.string() + kDomain, 3, "unknown_thing");
}

TEST(Command, a_wrong_scenario_is_named_with_file_and_line) {
  const TemporaryFile unknown_key("name: \"x\"\nbanana: 3\n");
  expect_refusal("run --scenario " + unknown_key.path.string() + kDomain, 2,
                 unknown_key.path.string() + ":2");
}

TEST(Command, a_recording_that_cannot_be_played_starts_nothing) {
  const std::string corpus = std::string(HANDSEL_SOURCE_DIR) + "/tests/fuzz/corpus/";
  const std::string run = "run --headless --scenario give_mug" + kDomain + " --human " + corpus;
  expect_refusal(run + "csv/millimetres.csv", 2,
                 "millimetres.csv:2: from waist to head the body measures 650");
  expect_refusal(run + "csv/time_backwards.csv", 2,
                 "time_backwards.csv:7: time 0.100000 is not after");
  expect_refusal(run + "bvh/truncated_motion.bvh", 2, "truncated_motion.bvh:");
  expect_refusal(run + "bvh/unknown_channel.bvh", 2,
                 "unknown_channel.bvh:5: channel \"Wrotation\" is unknown");
  expect_refusal(run + "nobody.bvh", 3, "nobody.bvh");
}

TEST(Command, a_wrong_joint_name_is_named) {
  const TemporaryFile scenario(
      "name: \"x\" start { key: \"elbow_of_nobody\" value: 1 } tasks { kind: \"give\" object: "
      "\"mug\" }");
  expect_refusal("run --scenario " + scenario.path.string() + kDomain, 2, "elbow_of_nobody");
}

TEST(Command, a_scenario_without_tasks_cannot_be_performed) {
  const TemporaryFile scenario("name: \"x\"\n");
  expect_refusal("run --scenario " + scenario.path.string() + kDomain, 2, "no tasks");
}

TEST(Command, asking_an_empty_domain_says_that_nothing_runs_there) {
  for (const char* command : {"status", "task give mug", "speed 50", "task cancel"})
    expect_refusal(command + kDomain, 3, "domain 208");
}

TEST(Command, topics_are_listed_as_json_lines) {
  const Outcome outcome = shell(kHandsel + " topic list");
  EXPECT_EQ(outcome.exit_code, 0);
  std::istringstream lines(outcome.out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count)
    EXPECT_FALSE(nlohmann::json::parse(line)["topic"].get<std::string>().empty());
  EXPECT_GT(count, 25);
}

TEST(Command, a_domain_in_use_is_refused_and_the_system_there_lives_on) {
  Background up({kHandsel, "up", "--headless", "--port", "0", "--domain", "208"});
  ASSERT_TRUE(up.wait_for("watch it at")) << up.said();
  const Outcome second = shell(kHandsel + " run --scenario give_mug" + kDomain);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr("domain 208 is in use"));
  const Outcome status = shell(kHandsel + " status" + kDomain);
  EXPECT_EQ(status.exit_code, 0) << status.out;
  EXPECT_EQ(up.interrupt(), 0);
  EXPECT_EQ(processes_running(), 0);
}

TEST(Command, a_taken_port_costs_the_page_and_nothing_else) {
  const int taken = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(taken, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(taken, 1), 0);
  getsockname(taken, reinterpret_cast<sockaddr*>(&address), &size);
  const std::string port = std::to_string(ntohs(address.sin_port));
  Background up({kHandsel, "up", "--headless", "--port", port, "--domain", "208"});
  ASSERT_TRUE(up.wait_for("no page: port " + port + " on 127.0.0.1 cannot be used")) << up.said();
  const Outcome status = shell(kHandsel + " status" + kDomain);
  EXPECT_EQ(status.exit_code, 0) << status.out;
  EXPECT_THAT(status.out, HasSubstr("cannot be used for the page"));
  EXPECT_EQ(up.interrupt(), 0);
  close(taken);
}

TEST(Command, one_process_a_box_runs_and_the_page_shows_them) {
  Background up({kHandsel, "up", "--headless", "--port", "0", "--domain", "208"});
  ASSERT_TRUE(up.wait_for("watch it at")) << up.said();
  const std::string running =
      shell("ps -eo args | grep -o '[b]in/handsel_[a-z_]* --domain 208' | sort | uniq -c").out;
  for (const char* box : kProcesses)
    EXPECT_THAT(running, testing::ContainsRegex(std::string(" 1 bin/handsel_") + box + " ")) << box;

  const std::string said = up.said();
  const auto port =
      static_cast<std::uint16_t>(std::atoi(said.substr(said.find("127.0.0.1:") + 10).c_str()));
  HttpClient settings(port);
  settings.request("GET", "/config.json");
  const std::string told = settings.read();
  for (const char* named : {"\"robot\":\"jido\"", "\"domain\":208", "\"mug\"", "handsel/scene"})
    EXPECT_THAT(told, HasSubstr(named)) << named;
  WebSocketClient viewer(port);
  viewer.read("\"advertise\"");
  viewer.frame(WebSocketClient::kText, R"({"op":"subscribeConnectionGraph"})");
  for (const char* box : kProcesses) {
    const std::string named = std::string("\"") + box + "\"";
    EXPECT_THAT(viewer.read(named), HasSubstr(named));
  }
  EXPECT_EQ(up.interrupt(), 0);
}

}  // namespace
}  // namespace handsel::test::command_test
