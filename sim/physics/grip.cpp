// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/grip.hpp"

namespace handsel::sim {

void Grip::hold(const Pose& T_holder_object) {
  holding_ = true;
  broke_ = false;
  time_at_max_ = 0;
  T_holder_object_ = T_holder_object;
}

const Wrench& Grip::update(const BodyState& holder, const BodyState& object, double mass,
                           double inertia, double dt) {
  wrench_ = Wrench{};
  if (!holding_) return wrench_;
  const Pose T_want = holder.T_world_body * T_holder_object_;
  const Vector3 arm = T_want.translation() - holder.T_world_body.translation();
  const Vector3 v_want = holder.velocity + holder.angular_velocity.cross(arm);
  const double w = settings_.frequency, d = 2 * settings_.damping_ratio * w;
  Vector3 force = mass * (w * w * (T_want.translation() - object.T_world_body.translation()) +
                          d * (v_want - object.velocity));
  const Eigen::AngleAxisd turn(T_want.linear() * object.T_world_body.linear().transpose());
  const double angle = turn.angle() > M_PI ? turn.angle() - 2 * M_PI : turn.angle();
  Vector3 torque = inertia * (w * w * angle * turn.axis() +
                              d * (holder.angular_velocity - object.angular_velocity));
  const double over =
      std::max(force.norm() / settings_.max_force, torque.norm() / settings_.max_torque);
  if (force.norm() > settings_.max_force) force *= settings_.max_force / force.norm();
  if (torque.norm() > settings_.max_torque) torque *= settings_.max_torque / torque.norm();
  time_at_max_ = over >= 1 ? time_at_max_ + dt : 0;
  if (time_at_max_ > settings_.break_time) {
    holding_ = false;
    broke_ = true;
    return wrench_;
  }
  wrench_ = {force, torque};
  return wrench_;
}

}  // namespace handsel::sim
