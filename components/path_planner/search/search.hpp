// SPDX-License-Identifier: Apache-2.0
// Random search for a first path: RRT-Connect, T-RRT and bidirectional T-RRT of this component;
// OMPL's RRT, RRT-Connect, T-RRT and BiT-RRT on the space, samples, checks and costs of this
// component.
#pragma once

#include "components/path_planner/search/search_space.hpp"
#include "components/path_planner/search/tree.hpp"

namespace handsel::path_planner {

struct Found {
  std::vector<Vector> path;  ///< empty if no path was found
  std::size_t goal{};        ///< index into `goals`
  /// Min distance between the trees, or between tree and goals, if no path was found [rad].
  double closest{};
  std::size_t nodes{};  ///< number of nodes of all trees
  /// Trees of this component's planners: from the start and, if there is one, from the goals.
  std::vector<Tree> trees{};
};

/// Searches a path until the budget is exhausted. All goals must be free. automatic: bidirectional
/// T-RRT with `heed_cost`, else RRT-Connect. A named planner runs in OMPL's framework
/// (ompl_planner): rrt is OMPL's, all others are those of this component, or OMPL's with `stock`.
/// The same seed gives the same path, regardless of preceding searches: no random number comes from
/// OMPL's generator.
Found search(SearchSpace& space, const std::vector<Vector>& goals, PlannerKind planner,
             bool heed_cost, std::uint64_t seed);

}  // namespace handsel::path_planner
