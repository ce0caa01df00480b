// SPDX-License-Identifier: Apache-2.0
// Two hands that take an object at once, carry it together and release it.
#pragma once

#include <functional>

#include "components/grasp_planner/regrasp/step_check.hpp"

namespace handsel::grasp_planner {

/// Returns the plan of RegraspPlanner::plan_together(). ConfigError unless there are two arms.
RegraspPlan carry_together(StepCheck& check, const TwoHandTask& task,
                           const std::function<bool()>& cancelled);

}  // namespace handsel::grasp_planner
