// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/transition_rrt.hpp"

#include <cmath>
#include <limits>

#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/transition_test.hpp"
#include "components/path_planner/search/tree.hpp"

namespace handsel::path_planner {

Found transition_rrt(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed) {
  Random random(seed);
  const Settings& settings = space.settings();
  TransitionTest accepts(
      {settings.initial_temperature, settings.temperature_factor, settings.max_refusals}, random);
  const double range = settings.transition_range;
  Tree tree(space.size());
  tree.add(space.start(), -1);
  std::vector<double> costs = {space.costs().of(space.start())};
  std::size_t refinements = 0;
  Found found;
  found.closest = std::numeric_limits<double>::infinity();
  while (!space.exhausted()) {
    space.charge(1);
    const bool to_goal = random.unit() < settings.goal_bias;
    const std::size_t goal =
        static_cast<std::size_t>(random.unit() * static_cast<double>(goals.size()));
    const Vector target =
        to_goal ? goals[goal]
                : space.upright().restore(random.within(space.lower(), space.upper()));
    const int near = tree.nearest(target);
    const double distance = (target - tree[near]).norm();
    const bool refines = distance < range;
    if (to_goal) found.closest = std::min(found.closest, distance);
    if (refines && !to_goal &&
        static_cast<double>(refinements) >
            settings.max_refinement_fraction * static_cast<double>(tree.size()))
      continue;
    const Vector q =
        refines ? target : Vector(tree[near] + (target - tree[near]) * (range / distance));
    const double cost = space.costs().of(q);
    if (!accepts(costs[static_cast<std::size_t>(near)], cost) || !space.motion_free(tree[near], q))
      continue;
    refinements += refines;
    const int added = tree.add(q, near);
    costs.push_back(cost);
    if (!(to_goal && refines)) continue;
    found.path = tree.branch(added);
    found.goal = goal;
    break;
  }
  found.nodes = static_cast<std::size_t>(tree.size());
  found.trees.push_back(std::move(tree));
  return found;
}

}  // namespace handsel::path_planner
