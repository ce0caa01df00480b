// RRT-Connect (Kuffner and LaValle) on flat arrays: whole motions go to the batch check at once,
// the nearest state is found many at a time, the smaller tree grows.
#pragma once

#include "components/path_planner/search/search.hpp"

namespace handsel::path_planner {

/// Searches with two trees until they meet or the space is exhausted; then the path is empty. All
/// goals must be free. `seed`: the same gives the same path.
Found connect(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed);

}  // namespace handsel::path_planner
