// SPDX-License-Identifier: Apache-2.0
// The planners on a landscape of costs over two axes, to look at (chapter Fig. 11).
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "common/messages/planning.hpp"

namespace handsel {

struct LandscapeResult {
  /// "solved", "trees": [[[x, y, parent], ...], ...], "raw" and "path": [[x, y], ...], "cost",
  /// "work", "length".
  nlohmann::json answer;
  std::string png;  ///< the landscape, both trees, and the path before and after smoothing
};

/// From one corner to the other between hills on [-1, 1] x [-1, 1]: the straight line goes over the
/// highest.
LandscapeResult plan_on_landscape(PlannerKind planner, std::uint64_t seed);

}  // namespace handsel
