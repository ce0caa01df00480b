// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/head/head_controller.hpp"

#include <cmath>

namespace handsel::trajectory_controller {

HeadController::HeadController(const RobotModel& robot, const std::vector<int>& axes,
                               const HeadSettings& settings)
    : robot_(robot), room_(robot, settings.clearance), movers_(robot, axes), settings_(settings) {
  target_.reserve(axes.size());
}

bool HeadController::has_new_target(const AttentionAdvice& advice) const noexcept {
  return !movers_.axes().empty() && advice.has_gaze_target &&
         !((advice.gaze_target - aimed_at_).norm() < settings_.min_target_motion);
}

void HeadController::aim_at(const AttentionAdvice& advice, const Pose& T_world_base,
                            const Vector& here, const std::vector<Vector>& ahead) {
  if (!has_new_target(advice)) return;
  const Vector3 p_root = T_world_base.inverse() * advice.gaze_target;
  std::vector<double> target = aim(robot_, *robot_.group("head"), here, p_root);
  if (!room_.lets_turn(here, target)) return;
  for (const Vector& q : ahead)
    if (!room_.lets_be(q, target)) return;
  aimed_at_ = advice.gaze_target;
  target_ = std::move(target);
}

void HeadController::reset(const Vector& position) noexcept {
  movers_.reset(position);
  target_.clear();
}

void HeadController::step(bool may_move, const std::vector<char>& on_path,
                          MotionState3& next) noexcept {
  for (std::size_t i = 0; i < movers_.axes().size(); ++i) {
    const int axis = movers_.axes()[i];
    if (on_path[static_cast<std::size_t>(axis)] != 0) {
      movers_.reset(axis, next.position[axis]);
      continue;
    }
    if (!may_move && !paused_) {
      movers_.stop(axis);
    } else if (may_move && !target_.empty() &&
               std::abs(target_[i] - movers_[axis].target()) > settings_.dead_band) {
      movers_.go_to(axis, target_[i]);
    }
    movers_.step(axis, settings_.period, next);
  }
  paused_ = !may_move;
}

}  // namespace handsel::trajectory_controller
