// SPDX-License-Identifier: Apache-2.0
// Two systems on one processor are slower but work. HANDSEL_RUNS: number of runs (1).
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::busy_machine_test {
namespace {

constexpr int kDomain = 203;

int runs() {
  const char* value = std::getenv("HANDSEL_RUNS");
  return value == nullptr ? 1 : std::atoi(value);
}

std::string command(int domain, const std::string& report) {
  return "taskset -c 0 " HANDSEL_COMMAND " run --headless --port 0 --timeout 300 --domain " +
         std::to_string(domain) + " --report " + report + " > " + report + ".log 2>&1; echo $? > " +
         report + ".exit";
}

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(BusyMachine, two_systems_on_one_processor_hand_their_mugs_over) {
  for (int run = 0; run < runs(); ++run) {
    const test::TemporaryFolder folder;
    const std::string one = folder.path() / "one", two = folder.path() / "two";
    test::shell("{ " + command(kDomain, one) + "; } & { " + command(kDomain + 1, two) +
                "; } & wait");
    for (const std::string& report : {one, two}) {
      SCOPED_TRACE("run " + std::to_string(run) + "\n" + text_of(report + ".log"));
      EXPECT_EQ(text_of(report + ".exit"), "0\n");
      const nlohmann::json said = nlohmann::json::parse(text_of(report), nullptr, false);
      ASSERT_TRUE(said.is_object());
      EXPECT_TRUE(said.value("success", false));
      EXPECT_EQ(said.value("late_cycles", -1), 0)
          << "a tick of the controller was left out or made late";
      EXPECT_EQ(said["restarts"], nlohmann::json::object());
      bool started = false;
      for (const auto& event : said["timeline"]) {
        const std::string what = event["event"];
        started = started || what.starts_with("task running");
        const bool silent_neighbour =
            what.starts_with("mode ") && what.find("silent") != std::string::npos;
        EXPECT_FALSE(started && silent_neighbour) << what;
      }
      EXPECT_TRUE(started);
    }
  }
}

}  // namespace
}  // namespace handsel::busy_machine_test
