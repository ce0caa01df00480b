// A grip: a compliant, breakable hold of limited force of an object by a hand, the robot's or a
// person's. Own method: a six-dimensional spring and damper scaled by the object's inertia is
// stable at the physics step.
#pragma once

#include "common/geometry/pose.hpp"

namespace handsel::sim {

struct GripSettings {
  /// Of the held object on its spring [rad/s]; below a tenth of the physics rate.
  double frequency{100.0};
  double damping_ratio{0.8};  ///< 1: critical
  double max_force{40.0};     ///< [N] the hold gives no more than this
  double max_torque{3.0};     ///< [Nm]
  double break_time{0.02};    ///< at the cap for this long: the hold breaks [s]
};

/// A rigid body at an instant, world frame; the pose is that of its centre of mass.
struct BodyState {
  Pose T_world_body{Pose::Identity()};  ///< origin at the centre of mass
  Vector3 velocity{Vector3::Zero()}, angular_velocity{Vector3::Zero()};  ///< [m/s], [rad/s]
};

class Grip {
 public:
  explicit Grip(const GripSettings& settings) : settings_(settings) {}

  /// Begins to hold the object at this pose of its centre of mass in the holder's frame.
  void hold(const Pose& T_holder_object);
  void release() { holding_ = false; }       ///< the next update() gives no wrench
  bool holding() const { return holding_; }  ///< false again after release() or a break
  bool broke() const { return broke_; }      ///< the last release was a break
  /// Returns the wanted pose of the object's centre of mass in the holder's frame.
  const Pose& T_holder_object() const { return T_holder_object_; }
  /// Changes the wanted pose of a hold under way.
  void set_T_holder_object(const Pose& T) { T_holder_object_ = T; }
  const Wrench& wrench() const { return wrench_; }  ///< last one given to the object

  /// Returns the wrench on the object about its centre of mass, world axes. Zero when nothing is
  /// held. `inertia`: least principal one [kg m^2].
  const Wrench& update(const BodyState& holder, const BodyState& object, double mass,
                       double inertia, double dt);

 private:
  GripSettings settings_;
  bool holding_{false}, broke_{false};
  double at_cap_{0};
  Pose T_holder_object_{Pose::Identity()};
  Wrench wrench_;
};

}  // namespace handsel::sim
