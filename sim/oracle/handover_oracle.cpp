// SPDX-License-Identifier: Apache-2.0
#include "sim/oracle/handover_oracle.hpp"

#include <algorithm>

namespace handsel::sim {

namespace {
constexpr double kLifted = 0.10;        // min lift by the giving robot [m]
constexpr double kShared = 0.2 - 1e-9;  // min time in which both hold the object [s]
constexpr double kAlone = 1.0 - 1e-9;   // min time in which the receiver then holds it alone [s]
}  // namespace

void HandoverOracle::observe(const ObjectSituation& now, double dt) {
  height_ = now.height;
  if (now.robot_grips) {
    lifted_ = std::max(lifted_, height_ - start_height_);
    max_lifted_ = std::max(max_lifted_, lifted_);
    contact_ = now.human_touches ? contact_ + dt : 0;
    contact_before_release_ = contact_;
  }
  const bool alone =
      now.human_grips && !now.robot_grips && !now.robot_touches && !now.on_surface && !now.on_floor;
  alone_ = alone ? alone_ + dt : 0;
  const bool robot_alone =
      now.robot_grips && !now.human_grips && !now.human_touches && !now.on_surface && !now.on_floor;
  robot_alone_ = robot_alone ? robot_alone_ + dt : 0;
  const bool both =
      with_person_ ? now.human_grips && now.robot_touches : now.robot_grips && now.human_touches;
  shared_ += both ? dt : 0;
  held_by_both_ += now.robot_grips && now.human_grips ? dt : 0;
  dropped_ = dropped_ || now.on_floor;
  last_ = now;
  if (with_person_ && robot_alone_ >= kAlone) {
    if (held_by_both_ >= kShared) count_handover();
    with_person_ = false;
  } else if (!with_person_ && alone_ >= kAlone) {
    if (lifted_ >= kLifted && contact_before_release_ >= kShared) count_handover();
    with_person_ = true;
  } else if (with_person_ && now.on_surface && !now.human_touches) {
    with_person_ = false;
  }
  if (handovers_ > 0 && now.on_surface) start_height_ = height_;
}

void HandoverOracle::count_handover() {
  if (dropped_) return;
  ++handovers_;
  lifted_ = shared_ = held_by_both_ = 0;
}

void HandoverOracle::write(GroundTruth& ground_truth) const {
  ground_truth.carrier = last_.robot_grips && last_.human_grips ? "both"
                         : last_.robot_grips                    ? "robot"
                         : last_.human_grips                    ? "human"
                         : last_.on_surface                     ? "surface"
                                                                : "";
  ground_truth.lifted = height_ - start_height_;
  ground_truth.max_lifted = max_lifted_;
  ground_truth.human_contact_before_release = contact_before_release_;
  ground_truth.human_alone = alone_;
  ground_truth.dropped = dropped_;
  ground_truth.handover_done = done();
  ground_truth.handovers = handovers_;
}

}  // namespace handsel::sim
