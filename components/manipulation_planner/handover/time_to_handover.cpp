// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/time_to_handover.hpp"

#include <algorithm>
#include <limits>

namespace handsel::manipulation_planner {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

}  // namespace

double time_to_handover(const ActionStatus& action, const Snapshot& now,
                        const settings::ManipulationPlannerSettings& settings) {
  if (action.state != ActionState::running) return kNever;
  const bool gives = action.kind == ActionKind::give, receives = action.kind == ActionKind::receive;
  const ActionPhase phase = action.phase;
  const bool is_engaged = receives && action.exchange_engaged;
  if (gives && phase == ActionPhase::offer) return 0;
  if (is_engaged && phase == ActionPhase::waiting_for_release) return 0;
  if (receives && phase == ActionPhase::grasp) return settings.predicted_close_time;
  const bool carries = gives && phase == ActionPhase::carry,
             reaches = phase == ActionPhase::reaching_object;
  const bool approaches = carries || (receives && (phase == ActionPhase::approach || reaches));
  const auto& status = now.execution();
  const ActiveTrajectory& active = now.active();
  if (!approaches || !status || status->motion != MotionState::running ||
      active.trajectory != status->trajectory)
    return kNever;
  const double left = std::max(0.0, active.rest.duration() - active.time) /
                      std::clamp(active.speed_factor, settings.predicted_min_factor, 1.0);
  return left + (phase == ActionPhase::approach ? settings.predicted_reach_time : 0.0) +
         (receives ? settings.predicted_close_time : 0.0);
}

}  // namespace handsel::manipulation_planner
