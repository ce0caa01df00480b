// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/connect.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/tree.hpp"

namespace handsel::path_planner {
Found connect(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed) {
  Random random(seed);
  const double range = space.settings().connect_range;
  Tree trees[2] = {Tree(space.size()), Tree(space.size())};
  trees[0].add(space.start(), -1);
  for (const Vector& goal : goals) trees[1].add(goal, -1);
  Found found;
  found.closest = std::numeric_limits<double>::infinity();
  while (!space.exhausted()) {
    space.charge(1);
    const int grows = trees[0].size() <= trees[1].size() ? 0 : 1;
    Tree &tree = trees[grows], &other = trees[1 - grows];
    const Vector target = space.upright().restore(random.within(space.lower(), space.upper()));
    const int near = tree.nearest(target);
    const Vector q = space.upright().toward(tree[near], target, range);
    if (q == tree[near] || !space.motion_free(tree[near], q)) continue;
    const int added = tree.add(q, near);
    int at = other.nearest(q);
    found.closest = std::min(found.closest, (q - other[at]).norm());
    while (other[at] != q) {
      const Vector next = space.upright().toward(other[at], q, range);
      if (next == other[at] || !space.motion_free(other[at], next)) break;
      at = other.add(next, at);
    }
    if (other[at] != q) continue;
    const int a = grows == 0 ? added : at, b = grows == 0 ? at : added;
    found.path = joined(trees[0], a, trees[1], b);
    found.goal = static_cast<std::size_t>(trees[1].root_of(b));
    break;
  }
  found.nodes =
      static_cast<std::size_t>(trees[0].size()) + static_cast<std::size_t>(trees[1].size());
  found.trees.assign(std::make_move_iterator(trees), std::make_move_iterator(trees + 2));
  return found;
}

}  // namespace handsel::path_planner
