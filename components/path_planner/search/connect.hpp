// RRT-Connect (Kuffner and LaValle) on flat arrays: whole motions go to the wide check at once, the nearest state is found many at a
// time, the smaller tree grows.
#pragma once

#include "components/path_planner/search/search.hpp"

namespace handsel::path_planner {

Found connect(SearchSpace& space, const std::vector<Vector>& goals, std::uint64_t seed);

}  // namespace handsel::path_planner
