// Making a path cheaper (chapter section 4.1.1): shortcuts and path perturbation, checked in the
// order cost, bounds, collision.
#pragma once

#include <vector>

#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/search_space.hpp"

namespace handsel::path_planner {

/// Improves a collision-free path; never returns one with a higher price. Ends stay. Stops when the
/// space is exhausted.
void smooth(SearchSpace& space, std::vector<Vector>& path, Random& random);

/// Drops nodes whose removal costs at most one part in fifty and stays free.
void prune(SearchSpace& space, std::vector<Vector>& path);

}  // namespace handsel::path_planner
