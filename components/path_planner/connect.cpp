#include "components/path_planner/connect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/path_planner/random.hpp"

namespace handsel::path_planner {
namespace {

/// States of a tree, axis by axis in single precision for the search of the nearest, whole in double for everything else.
class Tree {
 public:
  explicit Tree(int axes) : columns_(64, axes), distances_(64) {}

  int size() const { return static_cast<int>(states_.size()); }
  const Vector& operator[](int i) const { return states_[static_cast<std::size_t>(i)]; }
  int parent(int i) const { return parents_[static_cast<std::size_t>(i)]; }

  int add(const Vector& q, int parent) {
    const int i = size();
    if (i == columns_.rows()) {
      columns_.conservativeResize(2 * i, Eigen::NoChange);
      distances_.resize(2 * i);
    }
    columns_.row(i) = q.cast<float>().transpose();
    states_.push_back(q);
    parents_.push_back(parent);
    return i;
  }

  int nearest(const Vector& q) {
    const int n = size();
    distances_.head(n) = (columns_.col(0).head(n) - static_cast<float>(q[0])).square();
    for (int axis = 1; axis < q.size(); ++axis) distances_.head(n) += (columns_.col(axis).head(n) - static_cast<float>(q[axis])).square();
    int best = 0;
    distances_.head(n).minCoeff(&best);
    return best;
  }

  int root_of(int i) const {
    while (parent(i) >= 0) i = parent(i);
    return i;
  }

 private:
  Eigen::ArrayXXf columns_;  // a state a row; columns lie together
  Eigen::ArrayXf distances_;
  std::vector<Vector> states_;
  std::vector<int> parents_;
};

std::vector<Vector> joined(const Tree& from_start, int a, const Tree& from_goals, int b) {
  std::vector<Vector> path;
  for (int i = a; i >= 0; i = from_start.parent(i)) path.push_back(from_start[i]);
  std::reverse(path.begin(), path.end());
  for (int i = from_goals.parent(b); i >= 0; i = from_goals.parent(i)) path.push_back(from_goals[i]);
  return path;
}

}  // namespace

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
