// SPDX-License-Identifier: Apache-2.0
// deploy/docker-compose.yml and deploy/Dockerfile against the list of processes, the table of
// topics and the files they name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/dds/dds_configuration.hpp"
#include "common/topics/topics.hpp"
#include "deploy/handsel/system/processes.hpp"
#include "tests/support/processes/compose_file.hpp"

namespace handsel::test::compose_file_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
const fs::path kRoot = HANDSEL_SOURCE_DIR;

/// Returns a sentence for each fault of a compose file; empty: none.
std::vector<std::string> faults(const std::string& compose) {
  std::vector<std::string> out;
  const auto require = [&](bool holds, const std::string& otherwise) {
    if (!holds) out.push_back(otherwise);
  };
  const auto all = compose_services(compose);
  const std::set<std::string> processes(kProcesses.begin(), kProcesses.end());
  for (const std::string& process : processes)
    require(all.contains(process), process + " is no service");
  for (const auto& [name, text] : all) {
    require(processes.contains(name), "the service " + name + " is no process of the system");
    const auto has = [&, name = name, &text = text](const std::string& what) {
      require(text.find(what) != std::string::npos, name + " lacks \"" + what + "\"");
    };
    has("<<: *process\n");
    has("command: [handsel_" + name + ", --scenario, \"${HANDSEL_SCENARIO:-");
    has("healthcheck: {test: [CMD, handsel, health, " + name + "]");
    require(text.find("    environment:") == std::string::npos ||
                text.find("<<: *environment") != std::string::npos,
            name + " has an environment of its own without the common one");
    for (const char* own : {"HANDSEL_DOMAIN", "HANDSEL_PEERS", "CYCLONEDDS_URI", "--domain"})
      require(text.find(own) == std::string::npos, name + " says " + own + " for itself alone");
  }
  // A topic connects services: each end except a person's command, a real robot or an external
  // bridge is a service.
  const std::set<std::string> elsewhere{"handsel", "driver", "ros2_lane"};
  for (const TopicRow& row : topics())
    for (const char* list : {row.writers, row.readers}) {
      std::istringstream ends(list);
      for (std::string end; ends >> end;)
        require(all.contains(end) || elsewhere.contains(end),
                std::string(row.topic) + " has its end at " + end + ", which is no service");
    }
  const std::string common = compose.substr(0, compose.find("\nservices:\n"));
  for (const char* what :
       {"restart: unless-stopped", "read_only: true", "cap_drop: [ALL]", "no-new-privileges",
        "tmpfs:", "cpus:", "mem_limit:", "pids_limit:", "HANDSEL_DOMAIN: ${HANDSEL_DOMAIN:-0}",
        "HANDSEL_PEERS: ${HANDSEL_PEERS:-multicast}"})
    require(common.find(what) != std::string::npos,
            std::string("the services lack \"") + what + "\"");
  return out;
}

std::set<std::string> found(const std::string& text, const char* pattern) {
  std::set<std::string> out;
  const std::regex expression(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it)
    out.insert((*it)[1]);
  return out;
}

const std::string kCompose = text_of(kRoot / "deploy/docker-compose.yml");

TEST(ComposeFile, every_process_is_a_service_with_a_health_check_and_limits) {
  EXPECT_THAT(faults(kCompose), testing::IsEmpty());
}

TEST(ComposeFile, faults_are_seen) {
  const auto broken = [](const std::string& what, const std::string& by) {
    std::string text = kCompose;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return faults(text.replace(at, what.size(), by));
  };
  EXPECT_THAT(broken("  spark:\n", "  sparc:\n"), testing::Contains("spark is no service"));
  EXPECT_THAT(broken("handsel, health, spark", "handsel, health, sim"),
              testing::Contains(HasSubstr("spark lacks")));
  EXPECT_THAT(broken("[handsel_costmap,", "[handsel_spark,"),
              testing::Contains(HasSubstr("costmap lacks")));
  EXPECT_THAT(broken("      <<: *environment\n", "      HANDSEL_DOMAIN: 7\n"),
              testing::Contains("supervisor says HANDSEL_DOMAIN for itself alone"));
  EXPECT_THAT(broken("read_only: true", "read_only: false"),
              testing::Contains(HasSubstr("read_only")));
}

TEST(ComposeFile, on_several_hosts_every_service_is_there_too) {
  const auto services = compose_services(text_of(kRoot / "deploy/docker-compose.hosts.yml"));
  EXPECT_EQ(services.size(), kProcesses.size());
  for (const std::string process : kProcesses) EXPECT_TRUE(services.contains(process)) << process;
}

// podman-compose of Debian 12 supports only ${NAME:-default} with a non-empty default.
TEST(ComposeFile, every_variable_has_a_default_and_is_explained) {
  const std::string docs = text_of(kRoot / "docs/deploy.md");
  const auto variables = found(kCompose, R"(\$\{(\w+):-[^}]+\})");
  EXPECT_EQ(variables, found(kCompose, R"(\$\{?(\w+))"));
  EXPECT_GE(variables.size(), 5u);
  for (const std::string& variable : variables) {
    EXPECT_THAT(docs, HasSubstr("`" + variable + "`"));
    EXPECT_THAT(kCompose.substr(0, kCompose.find("\nx-process")), HasSubstr(variable));
  }
}

TEST(ComposeFile, files_it_names_exist) {
  for (const std::string& file : found(kCompose, R"(dockerfile: ([\w/.]+))"))
    EXPECT_TRUE(fs::exists(kRoot / file)) << file;
  for (const std::string& scenario : found(kCompose, R"(HANDSEL_SCENARIO:-(\w+))"))
    EXPECT_TRUE(fs::exists(kRoot / "sim/scenarios" / (scenario + ".txtpb"))) << scenario;
  const std::string dockerfile = text_of(kRoot / "deploy/Dockerfile");
  for (const std::string& file : found(dockerfile, R"(\n(?:RUN )?.*?\b(deploy/\w+\.sh))"))
    EXPECT_TRUE(fs::exists(kRoot / file)) << file;
  for (const std::string& base : found(dockerfile, R"(\nFROM (\S+))"))
    EXPECT_TRUE(base == "debian:bookworm" || base == "${TREE}") << base;
  EXPECT_THAT(dockerfile, HasSubstr("\nUSER handsel\n"));
}

TEST(ComposeFile, the_network_settings_let_every_topic_and_every_process_through) {
  const DdsConfiguration dds =
      read_dds_configuration("file://" HANDSEL_SOURCE_DIR "/deploy/dds/network.xml", 0);
  EXPECT_EQ(dds.error, "");
  EXPECT_TRUE(dds.multicast);
  EXPECT_EQ(dds.participant_index, "auto");
  EXPECT_GE(dds.max_auto_index, 60);
  ASSERT_TRUE(dds.max_sample_size.has_value());
  for (const TopicRow& row : topics()) EXPECT_LE(row.largest, *dds.max_sample_size) << row.topic;
}

}  // namespace
}  // namespace handsel::test::compose_file_test
