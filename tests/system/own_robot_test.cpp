// SPDX-License-Identifier: Apache-2.0
// Third-party robots by description alone: a Panda with its hand, an iiwa with a parallel gripper.
// Their URDFs are reference data.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/config/resources.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/eval/trial.hpp"
#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::own_robot_test {
namespace {

using Json = nlohmann::json;

std::vector<Json> in_lockstep(const std::string& scenario, const std::string& robot, int seeds) {
  std::vector<Trial> trials;
  NodeContext context = system_context(scenario, robot, 1);
  for (int seed = 1; seed <= seeds; ++seed) {
    context.seed = static_cast<std::uint64_t>(seed);
    trials.push_back({context, {.scenario = scenario}});
  }
  std::vector<Json> lines;
  EXPECT_TRUE(run_trials(trials, 2, [&](const Json& line) { lines.push_back(line); }))
      << "a trial crashed";
  return lines;
}

class OwnRobot : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    for (const char* robot : {"robots/franka_panda", "robots/kuka_iiwa14"})
      if (!test::reference_data(robot)) GTEST_SKIP() << "HANDSEL_DATA is not set";
  }
  static void give(int seeds, int at_least) {
    const std::string robot = GetParam();
    int done = 0;
    for (const Json& line : in_lockstep("give_box_" + robot, robot, seeds)) {
      const std::string what = robot + " seed " + line["seed"].dump();
      if (line["success"].get<bool>())
        ++done;
      else
        std::printf("%s: %s %s\n", what.c_str(), line["failure"].dump().c_str(),
                    line["reason"].dump().c_str());
      ASSERT_TRUE(line.contains("limit_ratio")) << what << ": " << line.dump();
      for (const char* derivative : {"v", "a", "j"})
        EXPECT_LE(line["limit_ratio"][derivative].get<double>(), 1.0 + 1e-6)
            << what << " " << derivative;
      EXPECT_EQ(line["ssm_violations"], 0) << what;
    }
    EXPECT_GE(done, at_least);
  }
};

TEST_P(OwnRobot, gives_the_object_once) { give(1, 1); }

using OwnRobotTen = OwnRobot;
TEST_P(OwnRobotTen, gives_the_object_nine_times_of_ten) { give(10, 9); }

INSTANTIATE_TEST_SUITE_P(Robots, OwnRobot, testing::Values("panda", "iiwa14"));
INSTANTIATE_TEST_SUITE_P(Robots, OwnRobotTen, testing::Values("panda", "iiwa14"));

test::Outcome model_check(const std::string& robot) {
  return test::shell(std::string(HANDSEL_COMMAND) + " model check " + robot);
}

TEST_P(OwnRobot, lacks_nothing) {
  const test::Outcome outcome = model_check(GetParam());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

/// The integrator's folder: description, URDF and SRDF lie together, far from the project; a limit
/// is forgotten.
TEST(OwnRobotFolder, is_enough_and_a_robot_without_limits_is_refused) {
  const auto data = test::reference_data("robots/kuka_iiwa14");
  if (!data) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const test::TemporaryFolder folder;
  const std::filesystem::path source = robot_description("iiwa14").parent_path();
  std::filesystem::copy(*data / "model.urdf", folder.path() / "model.urdf");
  std::filesystem::copy(*data / "meshes", folder.path() / "meshes");
  std::filesystem::copy(source / "iiwa14.srdf", folder.path() / "iiwa14.srdf");
  std::ifstream in(source / "iiwa14.txtpb");
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string far = "$HANDSEL_DATA/robots/kuka_iiwa14/model.urdf",
                    guard = "guard { joints: \"finger_joint\"";
  ASSERT_NE(text.find(far), std::string::npos);
  text.replace(text.find(far), far.size(), "model.urdf");
  const auto file = folder.write("mine.txtpb", text);
  const test::Outcome whole = model_check(file.string());
  EXPECT_EQ(whole.exit_code, 0) << whole.out << whole.err;

  ASSERT_NE(text.find(guard), std::string::npos);
  text.replace(text.find(guard), 5, "#gard");
  const auto lame = folder.write("lame.txtpb", text);
  const test::Outcome checked = model_check(lame.string());
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_NE(checked.out.find("guard has no entry for"), std::string::npos) << checked.out;
  const test::Outcome started = test::shell(
      std::string(HANDSEL_COMMAND) +
      " run --headless --port 0 --domain 66 --scenario give_box_iiwa14 --robot " + lame.string());
  EXPECT_EQ(started.exit_code, 2);
  EXPECT_NE(started.err.find("guard has no entry for \"finger_joint\""), std::string::npos)
      << started.err;
}

}  // namespace
}  // namespace handsel::own_robot_test
