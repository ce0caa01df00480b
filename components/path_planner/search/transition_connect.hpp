// SPDX-License-Identifier: Apache-2.0
// Bidirectional T-RRT (Devaurs, Simeon and Cortes; chapter section 4.1.1 for the transition test)
// on flat arrays: computes the costs along a motion in one batch and follows the motion up to the
// first state that fails the transition test.
#pragma once

#include "components/path_planner/search/search.hpp"

namespace handsel::path_planner {

/// Grows trees from the start and from the goals until they connect. The path is empty if the
/// budget of `space` was exhausted before. All goals must be free of collisions. The same `seed`
/// gives the same path.
Found transition_connect(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed);

}  // namespace handsel::path_planner
