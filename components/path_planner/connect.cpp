#include "components/path_planner/connect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/path_planner/random.hpp"
#include "components/path_planner/tree.hpp"

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
    const Vector target = random.within(space.lower(), space.upper());
    const int near = tree.nearest(target);
    const double distance = (target - tree[near]).norm();
    const Vector q = distance > range ? Vector(tree[near] + (target - tree[near]) * (range / distance)) : target;
    if (!space.motion_free(tree[near], q)) continue;
    const int added = tree.add(q, near);
    int at = other.nearest(q);
    const Vector along = q - other[at];
    const double gap = along.norm();
    found.closest = std::min(found.closest, gap);
    const int pieces = std::max(1, static_cast<int>(std::ceil(gap / range)));
    const Vector begin = other[at];
    for (int piece = 1; piece <= pieces; ++piece) {
      const Vector next = piece == pieces ? q : Vector(begin + along * (static_cast<double>(piece) / pieces));
      if (!space.motion_free(other[at], next)) break;
      at = other.add(next, at);
      if (piece < pieces) continue;
      const int a = grows == 0 ? added : at, b = grows == 0 ? at : added;
      found.path = joined(trees[0], a, trees[1], b);
      found.goal = static_cast<std::size_t>(trees[1].root_of(b));
      found.nodes = static_cast<std::size_t>(trees[0].size() + trees[1].size());
      return found;
    }
  }
  found.nodes = static_cast<std::size_t>(trees[0].size() + trees[1].size());
  return found;
}

}  // namespace handsel::path_planner
