// SPDX-License-Identifier: Apache-2.0
// The tree of `cmake --install` is complete: the command works from there, and a program outside
// the build takes part.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/bus/dds/dds_bus.hpp"
#include "common/messages/perception.hpp"
#include "tests/support/processes/shell.hpp"

namespace handsel::test::install_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::uint32_t kDomain = 204;

class Install : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::remove_all(folder());
    fs::create_directories(folder() / "empty");
    installed() = shell(HANDSEL_CMAKE " --install " HANDSEL_BUILD_DIR " --strip --prefix " +
                        prefix().string());
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }
  void SetUp() override { ASSERT_EQ(installed().exit_code, 0) << installed().err; }

  static fs::path folder() {
    return fs::temp_directory_path() / ("handsel-install-" + std::to_string(getpid()));
  }
  static fs::path prefix() { return folder() / "prefix"; }
  static Outcome& installed() {
    static Outcome outcome;
    return outcome;
  }
  /// With nothing of this environment but where programs are, from an empty folder.
  static Outcome clean_shell(const std::string& command, const std::string& variables = {}) {
    return shell("cd " + (folder() / "empty").string() + " && env -i PATH=/usr/bin:/bin HOME=" +
                 folder().string() + " " + variables + " " + command);
  }
};

TEST_F(Install, the_command_finds_everything_beside_itself) {
  const Outcome doctor = clean_shell((prefix() / "bin/handsel").string() +
                                     " doctor --json --port 0 --domain " + std::to_string(kDomain));
  EXPECT_EQ(doctor.exit_code, 0) << doctor.out << doctor.err;
  for (const char* subject :
       {"programs", "scenario", "robot", "objects", "settings", "DDS settings"})
    EXPECT_THAT(doctor.out, HasSubstr("\"subject\":\"" + std::string(subject) + "\""))
        << doctor.out;
  EXPECT_THAT(doctor.out, HasSubstr((prefix() / "share/handsel/dds/loopback.xml").string()));
  EXPECT_THAT(doctor.out, testing::Not(HasSubstr(HANDSEL_SOURCE_DIR)));
}

TEST_F(Install, a_program_in_c_outside_the_build_matches_every_topic_and_is_heard) {
  const std::string client = (folder() / "client").string();
  const Outcome configured = clean_shell(
      HANDSEL_CMAKE " -S " HANDSEL_SOURCE_DIR "/tests/system/client -B " + client +
      " -DCMAKE_PREFIX_PATH=" + prefix().string() + " -DCMAKE_C_FLAGS='-Wall -Wextra -Werror'");
  ASSERT_EQ(configured.exit_code, 0) << configured.out << configured.err;
  const Outcome built = clean_shell(HANDSEL_CMAKE " --build " + client);
  ASSERT_EQ(built.exit_code, 0) << built.out << built.err;

  setenv("CYCLONEDDS_URI", "file://" HANDSEL_SOURCE_DIR "/deploy/dds/loopback.xml", 1);
  DdsBus bus({.component = "install_test", .domain = kDomain, .health = false});
  std::vector<std::unique_ptr<AnyPublisher>> writers;
  std::vector<const SubscriptionStatus*> readers;
  for (std::size_t i = 0; i < topics().size(); ++i) {
    writers.push_back(bus.advertise_any(message_type(i), 1));
    if (topics()[i].type != std::string("HumanObservation"))
      readers.push_back(
          &bus.subscribe_any(message_type(i), [](const void*, const Receipt&) {}, {}));
  }
  HumanObservation heard;
  readers.push_back(&bus.subscribe<HumanObservation>(
      [&](const HumanObservation& m, const Receipt&) { heard = m; }));

  std::FILE* running = popen(("env -i HANDSEL_DOMAIN=" + std::to_string(kDomain) + " " + client +
                              "/client > " + client + ".out")
                                 .c_str(),
                             "w");
  const auto all_matched = [&] {  // each topic has one end in this process and one in the other
    for (const auto& writer : writers)
      if (writer->readers() < 2) return false;
    for (const SubscriptionStatus* reader : readers)
      if (reader->writers < 2) return false;
    return true;
  };
  EXPECT_TRUE(
      bus.run_until([&] { return all_matched() && !heard.people.empty(); }, from_seconds(10)));
  EXPECT_EQ(pclose(running), 0);
  for (std::size_t i = 0; i < writers.size(); ++i)
    EXPECT_GE(writers[i]->readers(), 1) << topics()[i].topic;
  ASSERT_EQ(heard.people.size(), 1u);
  EXPECT_EQ(heard.source, "outside");
  ASSERT_EQ(heard.people[0].joints.size(), 1u);
  EXPECT_EQ(heard.people[0].joints[0].name, "head");
  EXPECT_EQ(readers.back()->rejected, 0u) << readers.back()->last_rejection;
}

}  // namespace
}  // namespace handsel::test::install_test
