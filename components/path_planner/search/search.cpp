// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/search.hpp"

#include "components/path_planner/search/connect.hpp"
#include "components/path_planner/search/ompl_planner.hpp"
#include "components/path_planner/search/transition_connect.hpp"

namespace handsel::path_planner {

Found search(SearchSpace& space, const std::vector<Vector>& goals, PlannerKind kind, bool heed_cost,
             std::uint64_t seed) {
  // Without a named planner the search runs outside OMPL's framework, whose setup takes longer than
  // a short search.
  Found found = kind != PlannerKind::automatic
                    ? search_with_ompl(space, goals, kind,
                                       space.problem().stock || kind == PlannerKind::rrt, seed)
                : heed_cost ? transition_connect(space, goals, seed)
                            : connect(space, goals, seed);
  if (space.hooks().searched && !found.trees.empty())
    space.hooks().searched(found.trees[0], found.trees.size() > 1 ? &found.trees[1] : nullptr);
  return found;
}

}  // namespace handsel::path_planner
