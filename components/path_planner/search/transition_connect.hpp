// Bidirectional T-RRT (Devaurs, Simeon and Cortes; chapter section 4.1.1 for the transition test)
// on flat arrays: the costs along a whole motion are asked for at once, and it is followed as far
// as the transition test lets it.
#pragma once

#include "components/path_planner/search/search.hpp"

namespace handsel::path_planner {

/// Searches with two trees until they meet or the space is exhausted; then the path is empty. All
/// goals must be free. `seed`: the same gives the same path.
Found transition_connect(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed);

}  // namespace handsel::path_planner
