// The random search for a first path: RRT-Connect, T-RRT and bidirectional T-RRT of this component;
// OMPL's RRT, RRT-Connect, T-RRT and BiT-RRT on the space, samples, checks and costs of this
// component.
#pragma once

#include "components/path_planner/search/search_space.hpp"
#include "components/path_planner/search/tree.hpp"

namespace handsel::path_planner {

struct Found {
  std::vector<Vector> path;  ///< empty when nothing was found
  std::size_t goal{};        ///< index into `goals`
  /// Least distance between the two trees, or tree and goals, when nothing was found [rad].
  double closest{};
  std::size_t nodes{};  ///< of the tree or trees
  /// Of the planners here: from the start, and where one was grown from the goals.
  std::vector<Tree> trees{};
};

/// All goals must be free. automatic: bidirectional T-RRT when the cost is to be heeded, else
/// RRT-Connect. A planner that is named runs in OMPL's harness (ompl_planner): rrt is OMPL's, the
/// others are those of this component, or OMPL's where the problem says `stock`. Ends when the
/// space is exhausted. The same seed gives the same path, also with other searches before it in the
/// same process: no random number comes from OMPL's own generator.
Found search(SearchSpace& space, const std::vector<Vector>& goals, PlannerKind planner,
             bool heed_cost, std::uint64_t seed);

}  // namespace handsel::path_planner
