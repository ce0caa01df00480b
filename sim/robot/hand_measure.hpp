// What the robot side measures of the world's forces at a hand: wrist wrench, joint torques,
// payload (filtered as a sensor does); and the largest force on a person.
#pragma once

#include <vector>

#include "sim/physics/contacts.hpp"
#include "sim/robot/robot_body.hpp"
#include "sim/robot/robot_grasp.hpp"

namespace handsel::sim {

class HandMeasure {
 public:
  /// `cut_off`: of the low-pass filter [Hz]; `step`: physics step [s]. `whole`: the joint torques
  /// contain what touches the robot anywhere; else only the load of this hand's hold, as another
  /// hand's measure contains the rest.
  HandMeasure(int dof, double cut_off, double step, bool whole = true);

  /// Takes in one physics step; to be called once a step. `tool`: pose of the tool; `load`: wrench
  /// of the hold on the palm about `at`, world, zero when there is none.
  void update(const std::vector<Touch>&, const RobotBody&, const RobotGrasp&, const Pose& tool,
              const Wrench& load, const Vector3& at);

  const Wrench& wrist_wrench() const { return wrench_; }     ///< tool axes, at the tool's origin
  const Vector& external_torque() const { return torque_; }  ///< all axes [Nm] ([N])
  double payload() const { return payload_; }                ///< [kg]
  /// Normal force on a person, over 10 ms [N].
  double largest_contact() const { return largest_contact_; }

 private:
  double cut_off_, step_;
  bool whole_;
  Wrench wrench_;
  Vector torque_, external_;
  double payload_{0}, contact_{0}, largest_contact_{0};
};

}  // namespace handsel::sim
