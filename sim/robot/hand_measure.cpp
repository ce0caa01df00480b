// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/hand_measure.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {

HandMeasure::HandMeasure(int dof, double cut_off, double step, bool whole)
    : cut_off_(cut_off),
      step_(step),
      whole_(whole),
      torque_(Vector::Zero(dof)),
      external_(Vector::Zero(dof)) {}

void HandMeasure::update(const std::vector<Touch>& touches, const RobotBody& robot,
                         const RobotGrasp& grasp, const Pose& tool, const Wrench& load,
                         const Vector3& at) {
  Wrench wrench;
  external_.setZero();
  const Vector3 origin = tool.translation();
  const auto add = [&](int body, const Vector3& point, const Vector3& force,
                       const Vector3& torque) {
    if (whole_) robot.project(body, point, {force, torque}, external_);
    if (grasp.chain_of(body) < 0) return;
    wrench.force += force;
    wrench.torque += torque + (point - origin).cross(force);
  };
  double contact = 0;
  for (const Touch& t : touches) {
    if (t.a != Owner::robot || t.normal_force <= 0) continue;
    add(t.index_a, t.point, t.force_on_a, Vector3::Zero());
    if (t.b == Owner::person) contact += t.normal_force;
  }
  add(grasp.palm(), at, load.force, load.torque);
  if (!whole_) robot.project(grasp.palm(), at, load, external_);
  const auto filter_gain = [&](double rate) { return std::min(1.0, step_ * 2 * M_PI * rate); };
  const double k = filter_gain(cut_off_);
  wrench_.force += k * (tool.linear().transpose() * wrench.force - wrench_.force);
  wrench_.torque += k * (tool.linear().transpose() * wrench.torque - wrench_.torque);
  torque_ += k * (external_ - torque_);
  payload_ += filter_gain(5.0) * (-wrench.force.z() / 9.81 - payload_);
  contact_ += std::min(1.0, step_ / 0.01) * (contact - contact_);
  largest_contact_ = std::max(largest_contact_, contact_);
}

}  // namespace handsel::sim
