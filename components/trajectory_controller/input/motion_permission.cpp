// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/input/motion_permission.hpp"

#include <cmath>

namespace handsel::trajectory_controller {

void MotionPermission::set(const Go& go, TimePoint sampled) {
  const GoRefusal refusal = gate_.receive(go);
  if (refusal == GoRefusal::older_epoch) return;
  time_.mark(sampled);
  if (refusal != GoRefusal::none) return;
  go_ = go;
  const double factor = std::isfinite(go.override_factor) ? go.override_factor : 0.0;
  go_.override_factor = std::clamp(factor, 0.0, 1.0);
}

void MotionPermission::set(const SafetyState& safety) {
  gate_.receive(safety);
  safety_reason_ = safety.reason;
}

std::string MotionPermission::reason() const {
  const GoRefusal refusal = gate_.last_refusal();
  return refusal != GoRefusal::none ? text_of(refusal) : safety_reason_;
}

}  // namespace handsel::trajectory_controller
