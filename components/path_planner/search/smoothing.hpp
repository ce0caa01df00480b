// SPDX-License-Identifier: Apache-2.0
// Smoothing of a path (chapter section 4.1.1): shortcuts and path perturbation, checked in the
// order price, bounds, collision.
#pragma once

#include <vector>

#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/search_space.hpp"

namespace handsel::path_planner {

/// Improves a collision-free path; never increases the price or moves the ends. Stops when the
/// budget is exhausted.
void smooth(SearchSpace& space, std::vector<Vector>& path, Random& random);

/// Removes waypoints if the path stays free and the price rises by at most 2 %.
void prune(SearchSpace& space, std::vector<Vector>& path);

}  // namespace handsel::path_planner
