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

void SecondHand::come_back(double s, const Vector3& rest) {
  target_ = from_ + s * (rest - from_);
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
