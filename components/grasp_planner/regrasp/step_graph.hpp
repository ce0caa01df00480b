// SPDX-License-Identifier: Apache-2.0
// The graph of the steps that may be possible, and the cheapest sequence in it. Pure.
#pragma once

#include <compare>
#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include "components/grasp_planner/file_defaults.hpp"

namespace handsel::grasp_planner {

/// A state of the search: the object held, or at rest at one of the places of the task.
struct GraphNode {
  int arm{-1};          ///< index of the arm that holds the object; -1: on a support
  std::size_t index{};  ///< of the grasp in the list of the arm, or of the place
  auto operator<=>(const GraphNode&) const = default;
};

/// What a step costs beyond 1.
struct StepCosts {
  /// Of the worst quality: decides between sequences of equal length.
  double quality{file_defaults().regrasp_quality_cost};
  /// Max cost of a step whose grip force does not bear the load in every direction.
  double weak{file_defaults().regrasp_weak_cost};
  double max_weakness{file_defaults().regrasp_max_weakness};  ///< negative margin that costs so [N]
  /// Max cost of a strained step: strained steps are checked last.
  double strain{file_defaults().regrasp_strain_cost};
};

/// Steps between nodes. Each costs about 1; grasps decide between sequences of equal length.
class StepGraph {
 public:
  explicit StepGraph(const StepCosts& costs) : costs_(costs) {}

  /// Adds a step. `quality`: of its grasps, [0, 1]. `margin`: the smallest of the grasps that it
  /// leads from or to [N]. `strain`: StepCheck::strain(), [0, 1]. `pair`: of a
  /// pass: index of the pair of grasps.
  void add(const GraphNode& from, const GraphNode& to, double quality, double margin,
           double strain = 0, std::size_t pair = 0);
  /// Removes the step between two nodes.
  void remove(const GraphNode& from, const GraphNode& to);
  /// Returns the pair of a step that was added.
  std::size_t pair(const GraphNode& from, const GraphNode& to) const;
  /// Returns the nodes from `start` to the nearest for which `goal` holds; empty when there is
  /// none.
  std::vector<GraphNode> shortest(const GraphNode& start,
                                  const std::function<bool(const GraphNode&)>& goal) const;

 private:
  struct Edge {
    GraphNode to;
    double cost;
    std::size_t pair;
  };
  StepCosts costs_;
  std::map<GraphNode, std::vector<Edge>> edges_;
};

}  // namespace handsel::grasp_planner
