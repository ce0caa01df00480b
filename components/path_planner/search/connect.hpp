// SPDX-License-Identifier: Apache-2.0
// RRT-Connect (Kuffner and LaValle) on flat arrays: checks whole motions in batches, searches the
// nearest state with SIMD, and grows the smaller tree.
#pragma once

#include "components/path_planner/search/search.hpp"

namespace handsel::path_planner {

/// Searches with two trees until they meet or the budget is exhausted; then the path is empty. All
/// goals must be free. The same `seed` gives the same path.
Found connect(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed);

}  // namespace handsel::path_planner
