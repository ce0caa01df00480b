// SPDX-License-Identifier: Apache-2.0
#include "sim/people/two_hand_hold.hpp"

namespace handsel::sim {

void TwoHandHold::hold(const std::array<Pose, 2>& T_world_hand, const Pose& T_world_object) {
  for (std::size_t s = 0; s < 2; ++s) {
    T_object_hand_[s] = T_world_object.inverse() * T_world_hand[s];
    grips_[s].hold(Pose::Identity());
  }
}

void TwoHandHold::release() {
  for (Grip& grip : grips_) grip.release();
  on_object_ = {};
  on_hands_ = {};
}

void TwoHandHold::update(const std::array<BodyState, 2>& hands, const BodyState& object,
                         double mass, double inertia, double dt) {
  on_object_ = {};
  for (std::size_t s = 0; s < 2; ++s) {
    BodyState held = object;
    held.T_world_body = object.T_world_body * T_object_hand_[s];
    const Vector3 lever = held.T_world_body.translation() - object.T_world_body.translation();
    held.velocity += object.angular_velocity.cross(lever);
    const Wrench& w = grips_[s].update(hands[s], held, mass / 2, inertia / 2, dt);
    on_object_.force += w.force;
    on_object_.torque += w.torque + lever.cross(w.force);
    on_hands_[s] = {-w.force, -w.torque};
  }
  if (!holding()) release();
}

}  // namespace handsel::sim
