// SPDX-License-Identifier: Apache-2.0
// Dependencies are acyclic, and only wire and bus use DDS: checked on the #include lines of the
// whole tree.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file;  ///< relative to the source tree
  int line{};
  std::string target;  ///< as written
};

bool is_source(const fs::path& path) {
  return path.extension() == ".hpp" || path.extension() == ".cpp" || path.extension() == ".h";
}

std::vector<Include> includes_below(const std::string& folder) {
  const fs::path root = HANDSEL_SOURCE_DIR;
  const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> found;
  if (!fs::exists(root / folder)) return found;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    if (!entry.is_regular_file() || !is_source(entry.path())) continue;
    std::ifstream in(entry.path());
    int number = 0;
    for (std::string line; std::getline(in, line);) {
      ++number;
      std::smatch match;
      if (std::regex_search(line, match, pattern))
        found.push_back({fs::relative(entry.path(), root).string(), number, match[1]});
    }
  }
  return found;
}

bool starts_with(const std::string& text, const std::string& begin) {
  return text.rfind(begin, 0) == 0;
}
std::string where(const Include& include) {
  return include.file + ":" + std::to_string(include.line) + " includes " + include.target;
}

/// "components/spark/node.hpp" -> "spark"
std::string second_part(const std::string& path) {
  const std::size_t begin = path.find('/') + 1;
  return path.substr(begin, path.find('/', begin) - begin);
}

TEST(Includes, the_tree_is_read) { EXPECT_GT(includes_below("common").size(), 100u); }

TEST(Includes, common_knows_neither_components_nor_sim_nor_the_command) {
  for (const Include& include : includes_below("common")) {
    for (const char* above : {"components/", "sim/", "deploy/"})
      EXPECT_FALSE(starts_with(include.target, above)) << where(include);
  }
}

TEST(Includes, no_component_includes_another_or_what_is_above_it) {
  for (const Include& include : includes_below("components")) {
    for (const char* above : {"sim/", "deploy/"})
      EXPECT_FALSE(starts_with(include.target, above)) << where(include);
    if (starts_with(include.target, "components/")) {
      EXPECT_EQ(second_part(include.target), second_part(include.file)) << where(include);
    }
  }
}

TEST(Includes, the_simulator_stands_alone) {
  for (const Include& include : includes_below("sim")) {
    for (const char* other : {"components/", "deploy/"})
      EXPECT_FALSE(starts_with(include.target, other)) << where(include);
  }
}

TEST(Includes, drivers_of_real_robots_know_no_simulator) {
  for (const Include& include : includes_below("deploy/drivers")) {
    EXPECT_FALSE(starts_with(include.target, "sim/")) << where(include);
  }
}

TEST(Includes, only_wire_and_bus_know_dds) {
  const std::regex dds(R"(^(dds/|ddsc/|dds\.h|idl/|handsel_idl|.*\.idl|generated/idl))");
  for (const char* folder : {"common", "components", "sim", "deploy"}) {
    for (const Include& include : includes_below(folder)) {
      if (starts_with(include.file, "common/wire/") || starts_with(include.file, "common/bus/"))
        continue;
      EXPECT_FALSE(std::regex_search(include.target, dds)) << where(include);
    }
  }
}

TEST(Includes, only_the_simulator_knows_physics_and_only_the_bridge_knows_http) {
  for (const char* folder : {"common", "components", "sim", "deploy"}) {
    for (const Include& include : includes_below(folder)) {
      if (!starts_with(include.file, "sim/")) {
        EXPECT_FALSE(starts_with(include.target, "bullet/") || starts_with(include.target, "bt") ||
                     starts_with(include.target, "Bullet"))
            << where(include);
      }
      if (!starts_with(include.file, "components/bridge/")) {
        EXPECT_FALSE(starts_with(include.target, "boost/beast")) << where(include);
      }
    }
  }
}

/// Inside common: bus -> wire -> the rest -> geometry.
TEST(Includes, rooms_of_common_point_downward) {
  const std::map<std::string, int> height{
      {"base", 0},       {"geometry", 1}, {"grasp", 2},     {"trajectory", 2},
      {"messages", 3},   {"model", 4},    {"config", 4},    {"collision", 5},
      {"cost", 5},       {"record", 1},   {"wire", 6},      {"bus", 7},
      {"robot_side", 5}, {"topics", 0},   {"libraries", 6}, {"python", 6}};
  for (const Include& include : includes_below("common")) {
    if (!starts_with(include.target, "common/") ||
        include.target.find(".pb.h") != std::string::npos)
      continue;
    const auto from = height.find(second_part(include.file)),
               to = height.find(second_part(include.target));
    ASSERT_NE(from, height.end()) << include.file << " is in a room that is not placed";
    ASSERT_NE(to, height.end()) << where(include) << ", a room that is not placed";
    EXPECT_GE(from->second, to->second) << where(include);
  }
}

TEST(Includes, cores_know_no_clock_thread_or_logger) {
  const std::set<std::string> outside{
      "thread", "mutex", "condition_variable", "spdlog/spdlog.h", "unistd.h", "time.h", "ctime"};
  // Processes, nodes, bindings of a part to the bus, and files with external interfaces: the page's
  // server, with what it hands to the bus, the file of found grasps, the file of the safety state.
  const std::set<std::string> thin{
      "node.cpp",          "node.hpp",         "main.cpp",        "server.cpp",
      "server.hpp",        "server_state.hpp", "ros_topics.hpp",  "trajectory_link.hpp",
      "robots_link.hpp",   "grasp_store.cpp",  "state_store.cpp", "list_preparation.hpp",
      "command_queue.hpp", "steering.hpp"};
  for (const Include& include : includes_below("components")) {
    if (thin.count(fs::path(include.file).filename())) continue;
    EXPECT_FALSE(outside.count(include.target)) << where(include);
    EXPECT_FALSE(starts_with(include.target, "common/bus/")) << where(include);
  }
}

}  // namespace
