// SPDX-License-Identifier: Apache-2.0
// T-RRT (chapter section 4.1.1): an RRT whose new states must pass a transition test on their cost.
#pragma once

#include "components/path_planner/search/search.hpp"

namespace handsel::path_planner {

/// Grows one tree from the start until a goal is reached or the budget is exhausted; then the path
/// is empty. The same `seed` gives the same path.
Found transition_rrt(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed);

}  // namespace handsel::path_planner
