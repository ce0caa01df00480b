// SPDX-License-Identifier: Apache-2.0
// Several robots: in lock-step past a robot that reaches in between object and person, and two
// named systems in one DDS domain, each of which observes the robot of the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <google/protobuf/text_format.h>

#include <fstream>

#include "common/config/resources.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::test::several_robots_test {
namespace {

using ::testing::HasSubstr;

/// On the other side of the table of give_mug, with nothing to do.
constexpr const char* kAcross = R"(name: "across" robot: "jido"
base { xyz { x: 1.9 y: -0.9 } rpy { z: 3.1416 } }
human_sensors { source: "kinect" rate: 30 latency: 0.04 noise: 0.004 }
)";

/// Result of give_beside_robot.
struct Given {
  bool succeeded{};
  GroundTruth end;
  HumanState around;
};

Given give_beside(bool silent, std::uint64_t seed) {
  config::Scenario scenario;
  load_text_proto(scenario_file("give_beside_robot"), scenario);
  scenario.mutable_other_robots(0)->set_silent(silent);
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "beside.txtpb").string();
  std::string text;
  google::protobuf::TextFormat::PrintToString(scenario, &text);
  std::ofstream(file) << text;
  LockstepSystem system(system_context(file, "", seed));
  Given given;
  system.bus().subscribe<HumanState>(
      [&](const HumanState& m, const Receipt&) { given.around = m; });
  Performer performer(system.bus(), system.observer(), scenario, 0,
                      [&] { return not_ready(system.snapshot(), false).empty(); });
  const auto over = [&] {
    return performer.finished() ||
           (silent && system.snapshot().ground_truth.sample.min_robot_distance < 0);
  };
  system.network().run_until(over, TimePoint(from_seconds(200)));
  given.succeeded = performer.succeeded();
  given.end = system.snapshot().ground_truth.sample;
  return given;
}

TEST(SeveralRobots, a_mug_is_given_past_a_robot_that_reaches_in_between) {
  const Given given = give_beside(false, 1);
  // Whether the robots meet depends on when each passes: one start in which they do suffices.
  constexpr std::uint64_t kMaxStarts = 6;
  Given blind = give_beside(true, 1);
  for (std::uint64_t seed = 2; seed <= kMaxStarts && blind.end.min_robot_distance >= 0; ++seed)
    blind = give_beside(true, seed);
  EXPECT_TRUE(given.succeeded);
  EXPECT_EQ(given.end.self_or_scene_collisions, 0u);
  EXPECT_GT(given.end.min_robot_distance, 0.02);
  ASSERT_EQ(given.around.robots.size(), 1u);
  EXPECT_EQ(given.around.robots[0].name, "left");
  EXPECT_TRUE(blind.around.robots.empty());
  EXPECT_LT(blind.end.min_robot_distance, 0.0) << "a robot that does not report itself is met";
  std::printf("least distance of the robots %.3f m; without reports %.3f m\n",
              given.end.min_robot_distance, blind.end.min_robot_distance);
}

TEST(SeveralRobots, two_systems_with_names_work_in_one_domain_and_see_each_other) {
  const TemporaryFolder folder;
  const std::string across = (folder.path() / "across.txtpb").string(),
                    heard = (folder.path() / "heard").string();
  std::ofstream(across) << kAcross;
  const std::string command = HANDSEL_COMMAND, domain = " --domain 216 ";
  const std::string left = domain + "--name left ", right = domain + "--name right ";
  const Outcome started =
      shell(command + " up --scenario " + across + left + "--port 0 >/dev/null 2>&1 & echo $!");
  const std::string process = started.out.substr(0, started.out.find('\n'));
  ASSERT_FALSE(process.empty());
  const Outcome ready = shell("for i in $(seq 60); do " + command + " health" + left +
                              ">/dev/null 2>&1 && exit 0; sleep 0.5; done; exit 1");
  EXPECT_EQ(ready.exit_code, 0) << "the system \"left\" did not get ready";
  const Outcome second = shell(command + " up --scenario " + across + left + "--port 0");
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr("is in use by another system"));
  const Outcome run = shell(command + " run --scenario give_mug" + right + "--port 0 & give=$!; " +
                            "sleep 8; " + command + " topic echo human_state --json --count 1" +
                            right + ">" + heard + "; wait $give; echo \"run $?\"; cat " + heard);
  EXPECT_THAT(run.out, HasSubstr("run 0")) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\"name\":\"left\""))
      << "the robot of the other system is missing";
  EXPECT_THAT(run.out, ::testing::Not(HasSubstr("\"name\":\"right\"")));
  shell("kill -INT " + process + "; while kill -0 " + process + " 2>/dev/null; do sleep 0.1; done");
}

}  // namespace
}  // namespace handsel::test::several_robots_test
