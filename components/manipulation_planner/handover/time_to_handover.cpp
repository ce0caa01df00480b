#include "components/manipulation_planner/handover/time_to_handover.hpp"

#include <algorithm>
#include <limits>

namespace handsel::manipulation_planner {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kMinSpeedFactor = 0.05;  // that a motion is expected to have
constexpr double kReachTime = 1.5;        // of the straight motion in, after an approach [s]
constexpr double kCloseTime = 0.5;        // of the hand [s]

}  // namespace

double time_to_handover(const ActionStatus& action, const Snapshot& now) {
  if (action.state != ActionState::running) return kNever;
  const bool gives = action.kind == ActionKind::give, receives = action.kind == ActionKind::receive;
  const ActionPhase phase = action.phase;
  const bool is_engaged = receives && action.exchange_engaged;
  if (gives && phase == ActionPhase::offer) return 0;
  if (is_engaged && phase == ActionPhase::waiting_for_release) return 0;
  if (receives && phase == ActionPhase::grasp) return kCloseTime;
  const bool carries = gives && phase == ActionPhase::carry,
             reaches = phase == ActionPhase::reaching_object;
  const bool approaches = carries || (receives && (phase == ActionPhase::approach || reaches));
  const auto& status = now.execution();
  const ActiveTrajectory& active = now.active();
  if (!approaches || !status || status->motion != MotionState::running ||
      active.trajectory != status->trajectory)
    return kNever;
  const double left = std::max(0.0, active.rest.duration() - active.time) /
                      std::clamp(active.speed_factor, kMinSpeedFactor, 1.0);
  return left + (phase == ActionPhase::approach ? kReachTime : 0.0) + (receives ? kCloseTime : 0.0);
}

}  // namespace handsel::manipulation_planner
