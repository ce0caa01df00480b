// SPDX-License-Identifier: Apache-2.0
// Predicts when an object changes hands. Pure.
#pragma once

#include "common/config/settings/manipulation_planner.hpp"
#include "common/messages/task.hpp"
#include "components/manipulation_planner/snapshot.hpp"

namespace handsel::manipulation_planner {

/// Returns what the running motion still takes at its present speed, and what usually comes after
/// it [s]; infinite: no motion toward the handover runs.
double time_to_handover(const ActionStatus& action, const Snapshot& now,
                        const settings::ManipulationPlannerSettings& settings);

}  // namespace handsel::manipulation_planner
