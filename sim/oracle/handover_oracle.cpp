#include "sim/oracle/handover_oracle.hpp"

#include <algorithm>

namespace handsel::sim {

namespace {
constexpr double kLifted = 0.10;  // by the robot that gives [m]
constexpr double kShared = 0.2;   // both have hold of it [s]
constexpr double kAlone = 1.0;    // then who takes it has it alone [s]
}  // namespace

void HandoverOracle::observe(const ObjectSituation& now, double dt) {
  height_ = now.height;
  if (now.robot_grips) {
    max_lifted_ = std::max(max_lifted_, height_ - start_height_);
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
      from_person_ ? now.human_grips && now.robot_touches : now.robot_grips && now.human_touches;
  shared_ += both ? dt : 0;
  held_by_both_ += now.robot_grips && now.human_grips ? dt : 0;
  dropped_ = dropped_ || now.on_floor;
  const bool given =
      max_lifted_ >= kLifted && contact_before_release_ >= kShared && alone_ >= kAlone - 1e-9;
  const bool taken = held_by_both_ >= kShared - 1e-9 && robot_alone_ >= kAlone - 1e-9;
  done_ = done_ || (!dropped_ && (from_person_ ? taken : given));
  last_ = now;
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
  ground_truth.handover_done = done_;
}

}  // namespace handsel::sim
