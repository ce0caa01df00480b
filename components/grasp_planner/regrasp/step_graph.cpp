// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/regrasp/step_graph.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace handsel::grasp_planner {

void StepGraph::add(const GraphNode& from, const GraphNode& to, double quality, double margin,
                    double strain, std::size_t pair) {
  const double weak = std::clamp(-margin / costs_.max_weakness, 0.0, 1.0);
  const double cost =
      1 + costs_.quality * (1 - quality) + costs_.weak * weak + costs_.strain * strain;
  edges_[from].push_back({to, cost, pair});
}

void StepGraph::remove(const GraphNode& from, const GraphNode& to) {
  std::erase_if(edges_[from], [&](const Edge& e) { return e.to == to; });
}

std::size_t StepGraph::pair(const GraphNode& from, const GraphNode& to) const {
  const std::vector<Edge>& edges = edges_.at(from);
  return std::find_if(edges.begin(), edges.end(), [&](const Edge& e) { return e.to == to; })->pair;
}

std::vector<GraphNode> StepGraph::shortest(
    const GraphNode& start, const std::function<bool(const GraphNode&)>& goal) const {
  std::map<GraphNode, std::pair<double, GraphNode>> reached{{start, {0.0, start}}};
  std::set<std::pair<double, GraphNode>> open{{0.0, start}};
  while (!open.empty()) {
    const auto [cost, node] = *open.begin();
    open.erase(open.begin());
    if (goal(node)) {
      std::vector<GraphNode> path{node};
      while (path.back() != start) path.push_back(reached.at(path.back()).second);
      std::reverse(path.begin(), path.end());
      return path;
    }
    const auto from = edges_.find(node);
    if (from == edges_.end()) continue;
    for (const Edge& e : from->second) {
      const double total = cost + e.cost;
      const auto known = reached.find(e.to);
      if (known != reached.end() && known->second.first <= total) continue;
      if (known != reached.end()) open.erase({known->second.first, e.to});
      reached[e.to] = {total, node};
      open.insert({total, e.to});
    }
  }
  return {};
}

}  // namespace handsel::grasp_planner
