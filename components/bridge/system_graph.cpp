// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/system_graph.hpp"

#include <set>
#include <sstream>

#include "common/topics/topics.hpp"

namespace handsel::bridge {
namespace {

constexpr Duration kSilent =
    std::chrono::seconds(3);  // after which a component no longer counts as alive

}  // namespace

void SystemGraph::on(const ComponentHealth& health, TimePoint arrival) {
  const bool known = named_in(TopicOf<ComponentHealth>::row.writers, health.component);
  if (known && health.state != HealthState::stopping) last_health_[health.component] = arrival;
}

Graph SystemGraph::graph(TimePoint now, const std::vector<bool>& read_here) const {
  std::set<std::string> alive;
  for (const auto& [component, at] : last_health_)
    if (now - at < kSilent) alive.insert(component);
  const auto living = [&](const char* list) {
    std::set<std::string> out;
    std::istringstream words(list);
    for (std::string word; words >> word;)
      if (alive.contains(word)) out.insert(word);
    return out;
  };
  Graph out;
  for (const TopicRow& row : topics()) {
    out.writers[row.topic] = living(row.writers);
    out.readers[row.topic] = living(row.readers);
    if (read_here[static_cast<std::size_t>(&row - topics().data())])
      out.readers[row.topic].insert("bridge");
  }
  return out;
}

}  // namespace handsel::bridge
