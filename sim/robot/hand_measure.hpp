// SPDX-License-Identifier: Apache-2.0
// Computes the robot side's measurements at a hand: wrist wrench, joint torques and payload,
// low-pass filtered as by a sensor; and the max force on a person.
#pragma once

#include <vector>

#include "sim/physics/contacts.hpp"
#include "sim/robot/robot_body.hpp"
#include "sim/robot/robot_grasp.hpp"

namespace handsel::sim {

class HandMeasure {
 public:
  /// `cut_off`: cut-off of the low-pass filter [Hz]; `step`: physics step [s]. `whole`: the joint
  /// torques contain all contacts of the robot; else only the load of this hand's grasp constraint,
  /// because another hand's measurement contains the rest.
  HandMeasure(int dof, double cut_off, double step, bool whole = true);

  /// Evaluates one physics step. `tool`: pose of the tool, world; `load`: wrench of the grasp
  /// constraint on the palm about `at`, world, or zero.
  void update(const std::vector<Touch>&, const RobotBody&, const RobotGrasp&, const Pose& tool,
              const Wrench& load, const Vector3& at);

  const Wrench& wrist_wrench() const { return wrench_; }     ///< tool axes, at the tool's origin
  const Vector& external_torque() const { return torque_; }  ///< all axes [Nm] ([N])
  double payload() const { return payload_; }                ///< [kg]
  /// Returns the max normal force on a person, filtered over 10 ms [N].
  double largest_contact() const { return largest_contact_; }

 private:
  double cut_off_, step_;
  bool whole_;
  Wrench wrench_;
  Vector torque_, external_;
  double payload_{0}, contact_{0}, largest_contact_{0};
};

}  // namespace handsel::sim
