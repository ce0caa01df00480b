// SPDX-License-Identifier: Apache-2.0
#include "sim/people/second_hand.hpp"

#include <algorithm>

namespace handsel::sim {

void SecondHand::begin(const Vector3& from, const Eigen::Quaterniond& R_world_rest) {
  active_ = true;
  from_ = target_ = from;
  R_world_rest_ = R_world_rest;
}

void SecondHand::reach(double s, double curve, const Pose& T_world_object) {
  if (active_) target_ = taking_.position_at(from_, s, curve, T_world_object);
}

void SecondHand::begin_return(double curve) {
  from_ = target_;
  behind_.reset();
  if (configuration_) behind_ = TakingHand::behind(from_, curve, configuration_->R_world_hand);
}

void SecondHand::come_back(double s, const Vector3& rest) {
  const Vector3 control = behind_.value_or((from_ + rest) / 2);
  target_ = (1 - s) * (1 - s) * from_ + 2 * s * (1 - s) * control + s * s * rest;
  if (s >= 1) active_ = false;
}

void SecondHand::configure(double turned, double closed, const Pose& T_world_object) {
  if (active_ && taking_.has_place())
    configuration_ = taking_.configuration(R_world_rest_, turned, closed, T_world_object);
}

void SecondHand::open(double part) {
  if (!configuration_) return;
  for (double& closure : configuration_->closures) closure = std::max(0.0, closure - part);
}

void SecondHand::forget() {
  configuration_.reset();
  taking_.forget();
}

}  // namespace handsel::sim
