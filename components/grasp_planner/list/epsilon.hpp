// SPDX-License-Identifier: Apache-2.0
// Ferrari-Canny epsilon, L1: how far the origin is inside the convex hull of the wrenches
// (formulas: section 3).
#pragma once

#include "common/grasp/force_closure.hpp"

namespace handsel::grasp_planner {

/// Largest dimension epsilon() handles.
inline constexpr int kMaxWrenchDimension = 10;

/// Distance of the origin to the boundary of the hull when it is strictly inside, else 0 (also when
/// the set does not span the space). Exact: only the facet nearest to the origin is grown until it
/// belongs to the hull. Dimension 1 to kMaxWrenchDimension, at most 65535 wrenches; outside of that
/// ConfigError.
double epsilon(const WrenchMatrix& wrenches);

}  // namespace handsel::grasp_planner
