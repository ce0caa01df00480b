#include "components/path_planner/transition_rrt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/path_planner/random.hpp"
#include "components/path_planner/transition_test.hpp"

namespace handsel::path_planner {
namespace {

constexpr double kGoalBias = 0.1;
constexpr double kRefinementShare = 0.1;

struct Node {
  Vector q;
  int parent{-1};
  double cost{};
};

int nearest(const std::vector<Node>& tree, const Vector& q) {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < static_cast<int>(tree.size()); ++i) {
    const double d = (tree[i].q - q).squaredNorm();
    if (d >= least) continue;
    least = d;
    best = i;
  }
  return best;
}

}  // namespace

Found transition_rrt(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed) {
  Random random(seed);
  TransitionTest accepts(space.settings().initial_temperature, random);
  const double range = space.settings().transition_range;
  std::vector<Node> tree = {{space.start(), -1, space.cost(space.start())}};
  std::size_t refinements = 0;
  Found found;
  found.closest = std::numeric_limits<double>::infinity();
  while (!space.exhausted()) {
    space.charge(1);
    const bool to_goal = random.unit() < kGoalBias;
    const std::size_t goal = static_cast<std::size_t>(random.unit() * static_cast<double>(goals.size()));
    const Vector target = to_goal ? goals[goal] : space.righted(random.within(space.lower(), space.upper()));
    const int near = nearest(tree, target);
    const double distance = (target - tree[near].q).norm();
    const bool refines = distance < range;
    if (to_goal) found.closest = std::min(found.closest, distance);
    if (refines && !to_goal && static_cast<double>(refinements) > kRefinementShare * static_cast<double>(tree.size())) continue;
    const Vector q = refines ? target : Vector(tree[near].q + (target - tree[near].q) * (range / distance));
    const double cost = space.cost(q);
    if (!accepts(tree[near].cost, cost) || !space.motion_free(tree[near].q, q)) continue;
    refinements += refines;
    tree.push_back({q, near, cost});
    if (!(to_goal && refines)) continue;
    for (int i = static_cast<int>(tree.size()) - 1; i >= 0; i = tree[i].parent) found.path.push_back(tree[i].q);
    std::reverse(found.path.begin(), found.path.end());
    found.goal = goal;
    break;
  }
  found.nodes = tree.size();
  return found;
}

}  // namespace handsel::path_planner
