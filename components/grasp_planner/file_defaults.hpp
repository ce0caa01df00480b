// SPDX-License-Identifier: Apache-2.0
// Defaults of the settings file, for parts that are used without one.
#pragma once

#include "common/config/settings/grasp_planner.hpp"

namespace handsel::grasp_planner {

/// Returns the default of each setting.
inline const settings::GraspPlannerSettings& file_defaults() {
  static const settings::GraspPlannerSettings defaults;
  return defaults;
}

}  // namespace handsel::grasp_planner
