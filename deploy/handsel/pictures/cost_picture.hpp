// SPDX-License-Identifier: Apache-2.0
// Pictures of the human-aware costs on the vertical plane through a person's taking arm.
#pragma once

#include <string>

#include "common/cost/human_cost.hpp"

namespace handsel {

/// Four maps (safety, visibility, arm comfort, their weighted sum) around the person, as SVG: cells
/// of `cell` [m] of the vertical plane through the right shoulder along the person's front, from 1
/// m behind to 2 m before them, from the floor to 2.2 m.
std::string cost_picture(const Person& person, const CostSettings& settings, double cell,
                         const std::string& title);

}  // namespace handsel
