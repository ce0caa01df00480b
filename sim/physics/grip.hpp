// SPDX-License-Identifier: Apache-2.0
// A grip: a compliant connection of limited force that can break, between an object and a hand of
// robot or person. Own method: a six-dimensional spring and damper scaled by the object's inertia
// is stable at the physics step.
#pragma once

#include "common/geometry/pose.hpp"

namespace handsel::sim {

struct GripSettings {
  /// Natural frequency of the held object on the spring [rad/s]; below 1/10 of the physics rate.
  double frequency{100.0};
  double damping_ratio{0.8};  ///< 1: critical
  double max_force{40.0};     ///< max force of the spring [N]
  double max_torque{3.0};     ///< max torque of the spring [Nm]
  double break_time{0.02};    ///< time at the max force or torque after which the grip breaks [s]
};

/// The state of a rigid body at an instant, world frame; the origin is the centre of mass.
struct BodyState {
  Pose T_world_body{Pose::Identity()};  ///< origin at the centre of mass
  Vector3 velocity{Vector3::Zero()}, angular_velocity{Vector3::Zero()};  ///< [m/s], [rad/s]
};

class Grip {
 public:
  explicit Grip(const GripSettings& settings) : settings_(settings) {}

  /// Begins a grip with this pose of the object's centre of mass in the holder's frame.
  void hold(const Pose& T_holder_object);
  void release() { holding_ = false; }       ///< Ends the grip; update() then returns zero.
  bool holding() const { return holding_; }  ///< whether the grip exists
  bool broke() const { return broke_; }      ///< whether the last grip ended by a break
  /// Returns the target pose of the object's centre of mass in the holder's frame.
  const Pose& T_holder_object() const { return T_holder_object_; }
  /// Changes the target pose of the present grip.
  void set_T_holder_object(const Pose& T) { T_holder_object_ = T; }
  const Wrench& wrench() const { return wrench_; }  ///< last wrench on the object

  /// Returns the wrench on the object about its centre of mass, world axes; zero without a grip.
  /// `inertia`: min principal moment [kg m^2]; `dt` [s].
  const Wrench& update(const BodyState& holder, const BodyState& object, double mass,
                       double inertia, double dt);

 private:
  GripSettings settings_;
  bool holding_{false}, broke_{false};
  double time_at_max_{0};
  Pose T_holder_object_{Pose::Identity()};
  Wrench wrench_;
};

}  // namespace handsel::sim
