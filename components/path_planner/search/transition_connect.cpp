// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/transition_connect.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/transition_test.hpp"
#include "components/path_planner/search/tree.hpp"

namespace handsel::path_planner {
namespace {

constexpr double kMinStep = 0.02;  // min length of an extension [rad]

TransitionSettings transition_of(const Settings& s) {
  return {s.initial_temperature, s.temperature_factor, s.max_refusals};
}

class Search {
 public:
  Search(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed)
      : space_(space),
        random_(seed),
        test_{{transition_of(space.settings()), random_},
              {transition_of(space.settings()), random_}},
        trees_{Tree(space.size()), Tree(space.size())} {
    trees_[0].add(space.start(), -1);
    for (const Vector& goal : goals) trees_[1].add(goal, -1);
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < trees_[side].size(); ++i)
        cost_[side].push_back(space.costs().of(trees_[side][i]));
  }

  Found run() {
    Found found;
    found.closest = std::numeric_limits<double>::infinity();
    while (!space_.exhausted() && found.path.empty()) {
      space_.charge(1);
      const int side = trees_[0].size() <= trees_[1].size() ? 0 : 1;
      const Vector target =
          space_.upright().restore(random_.within(space_.lower(), space_.upper()));
      const int near = trees_[side].nearest(target);
      const int added = advance(side, near, target, space_.settings().connect_range);
      if (added == near) continue;
      const Vector q = trees_[side][added];
      const int begin = trees_[1 - side].nearest(q);
      found.closest = std::min(found.closest, (trees_[1 - side][begin] - q).norm());
      int at = begin;
      for (bool reached = false; !reached;) {
        const int next = advance(1 - side, at, q, space_.settings().connect_range, &reached);
        if (next == at) break;
        at = next;
        if (!reached) continue;
        const int a = side == 0 ? added : at, b = side == 0 ? at : added;
        found.path = joined(trees_[0], a, trees_[1], b);
        found.goal = static_cast<std::size_t>(trees_[1].root_of(b));
      }
    }
    found.nodes =
        static_cast<std::size_t>(trees_[0].size()) + static_cast<std::size_t>(trees_[1].size());
    found.trees.assign(std::make_move_iterator(trees_), std::make_move_iterator(trees_ + 2));
    return found;
  }

 private:
  /// Extends a node toward a target by at most `range`, as far as the transition test allows;
  /// returns the new node, or the old one.
  int advance(int side, int from, const Vector& target, double range, bool* reached = nullptr) {
    const Vector start = trees_[side][from], stop = space_.upright().toward(start, target, range);
    const double length = (stop - start).norm();
    if (length < kMinStep) {
      if (reached == nullptr || stop != target || !space_.motion_free(start, target)) return from;
      *reached = true;
      return add(side, from, target, space_.costs().of(target));
    }
    const int steps =
        std::max(1, static_cast<int>(std::ceil(length / space_.settings().cost_step)));
    const std::vector<double>& costs = space_.costs().at_steps(start, stop, steps);
    double last = cost_[side][static_cast<std::size_t>(from)];
    int allowed = 0;
    for (; allowed < steps && test_[side](last, costs[static_cast<std::size_t>(allowed)]);
         ++allowed)
      last = costs[static_cast<std::size_t>(allowed)];
    if (allowed == 0) return from;
    const Vector q = allowed == steps
                         ? stop
                         : Vector(start + (stop - start) * (static_cast<double>(allowed) / steps));
    if (!space_.motion_free(start, q)) return from;
    if (reached) *reached = allowed == steps && stop == target;
    return add(side, from, q, last);
  }

  int add(int side, int parent, const Vector& q, double cost) {
    cost_[side].push_back(cost);
    return trees_[side].add(q, parent);
  }

  SearchSpace& space_;
  Random random_;
  TransitionTest test_[2];
  Tree trees_[2];
  std::vector<double> cost_[2];
};

}  // namespace

Found transition_connect(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed) {
  return Search(space, goals, seed).run();
}

}  // namespace handsel::path_planner
