#include "sim/handover_oracle.hpp"

#include <algorithm>

namespace handsel::sim {

void HandoverOracle::observe(const ObjectSituation& now, double dt) {
  height_ = now.height;
  if (now.robot_grips) {
    max_lifted_ = std::max(max_lifted_, height_ - start_height_);
    contact_ = now.human_touches ? contact_ + dt : 0;
    contact_before_release_ = contact_;
  }
  const bool alone = now.human_grips && !now.robot_grips && !now.robot_touches && !now.on_surface && !now.on_floor;
  alone_ = alone ? alone_ + dt : 0;
  dropped_ = dropped_ || now.on_floor;
  done_ = done_ || (!dropped_ && max_lifted_ >= 0.10 && contact_before_release_ >= 0.2 && alone_ >= 1.0 - 1e-9);
  last_ = now;
}

void HandoverOracle::write(GroundTruth& truth) const {
  truth.carrier = last_.robot_grips && last_.human_grips ? "both"
                  : last_.robot_grips                    ? "robot"
                  : last_.human_grips                    ? "human"
                  : last_.on_surface                     ? "surface"
                                                         : "";
  truth.lifted = height_ - start_height_;
  truth.max_lifted = max_lifted_;
  truth.human_contact_before_release = contact_before_release_;
  truth.human_alone = alone_;
  truth.dropped = dropped_;
  truth.handover_done = done_;
}

}  // namespace handsel::sim
