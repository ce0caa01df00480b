// SPDX-License-Identifier: Apache-2.0
// Human-aware costs (chapter section 4.1.2); the library handsel::cost.
//
//   HumanCost                cost of a robot configuration: safety, visibility, arm comfort
//   safety_cost(), visibility_cost(), arm_comfort_cost(), point_cost()    its parts
//   load_cost_settings()     settings from a file
#pragma once

#include "common/cost/cost_settings.hpp"
#include "common/cost/human_cost.hpp"
#include "handsel/collision.hpp"
