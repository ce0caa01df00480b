// SPDX-License-Identifier: Apache-2.0
// The table of topics against the nodes, all in one process and virtual time: the actual readers
// and writers of each topic, and no malformed message.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "common/bus/local_bus.hpp"
#include "common/bus/node_context.hpp"
#include "common/messages/system.hpp"
#include "components/attention/node.hpp"
#include "components/collision_checker/node.hpp"
#include "components/costmap/node.hpp"
#include "components/grasp_planner/node.hpp"
#include "components/manipulation_planner/node.hpp"
#include "components/path_planner/node.hpp"
#include "components/spark/node.hpp"
#include "components/supervisor/node.hpp"
#include "components/trajectory_controller/node.hpp"
#include "components/trajectory_planner/node.hpp"
#include "sim/node.hpp"

namespace handsel::table_test {
namespace {

class Table : public testing::Test {
 protected:
  Table() {
    setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
    context = load_context("jido", HANDSEL_SOURCE_DIR "/sim/scenarios/give_mug.txtpb");
    add<sim::Node>("sim");
    add<spark::Node>("spark");
    add<costmap::Node>("costmap");
    add<collision_checker::Node>("collision_checker");
    add<path_planner::Node>("path_planner");
    add<grasp_planner::Node>("grasp_planner");
    add<trajectory_planner::Node>("trajectory_planner");
    add<manipulation_planner::Node>("manipulation_planner");
    add<attention::Node>("attention");
    add<trajectory_controller::Node>("trajectory_controller");
    add<supervisor::Node>("supervisor");
  }
  template <class Node>
  void add(const std::string& component) {
    nodes.push_back(std::make_shared<Node>(network.add(component), context));
  }
  NodeContext context;
  LocalNetwork network{1};
  std::vector<std::shared_ptr<void>> nodes;
};

std::set<std::string> words(const char* list) {
  std::istringstream in(list);
  std::set<std::string> out;
  for (std::string word; in >> word;)
    if (word != "handsel" && word != "bridge" && word != "driver" && word != "ros2_lane")
      out.insert(word);  // not in this process: command, page, real robot, ROS 2 bridge
  return out;
}

TEST_F(Table, names_the_writers_and_readers_there_are) {
  std::map<std::string, std::set<std::string>> readers, writers;
  for (const auto& endpoint : network.endpoints())
    (endpoint.writes ? writers : readers)[endpoint.type].insert(endpoint.component);
  for (const TopicRow& row : topics()) {
    // Used between processes only (tests/system/busy_machine_test.cpp): lock-step has a single
    // clock.
    if (row.type == std::string("SimClock") || row.type == std::string("ClockReached")) continue;
    std::set<std::string> expected_writers = words(row.writers);
    expected_writers.erase("bridge");
    EXPECT_EQ(writers[row.type], expected_writers) << "writers of " << row.type;
    std::set<std::string> expected_readers = words(row.readers);
    if (row.type == std::string("HumanObservation"))
      expected_readers.erase("sim");  // reads only in a scenario with an external person
    EXPECT_EQ(readers[row.type], expected_readers) << "readers of " << row.type;
  }
}

TEST_F(Table, nobody_sends_what_others_must_reject) {
  std::map<std::string, ComponentHealth> health;
  network.add("observer").subscribe<ComponentHealth>([&](const ComponentHealth& m, const Receipt&) {
    health[m.component] = m;
  });
  network.run_for(std::chrono::seconds(2));
  EXPECT_EQ(health.size(), nodes.size() + 1);
  for (const auto& [component, m] : health) {
    EXPECT_EQ(m.reason.find("refused to send"), std::string::npos) << component << ": " << m.reason;
    for (const TopicHealth& topic : m.topics)
      EXPECT_EQ(topic.rejected, 0u) << component << ": " << topic.last_rejection;
  }
}

}  // namespace
}  // namespace handsel::table_test
