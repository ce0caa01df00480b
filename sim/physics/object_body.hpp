// SPDX-License-Identifier: Apache-2.0
// An object as a rigid body of the physics world.
#pragma once

#include <memory>

#include "sim/physics/bullet.hpp"
#include "sim/physics/grip.hpp"
#include "sim/scene/scene_setup.hpp"

namespace handsel::sim {

class ObjectBody {
 public:
  /// Throws ConfigError if the model has no collision parts. `index`: number in contacts.
  ObjectBody(const StartObject& start, int index, ShapeStore&, btDynamicsWorld&);
  ~ObjectBody();
  ObjectBody(const ObjectBody&) = delete;
  ObjectBody& operator=(const ObjectBody&) = delete;

  const StartObject& start() const { return start_; }         ///< as placed by the scenario
  const ObjectModel& model() const { return *start_.model; }  ///< of the object library
  double min_inertia() const { return min_inertia_; }         ///< min principal moment [kg m^2]
  /// Returns the pose of the object frame as of the last read().
  const Pose& T_world_object() const { return T_world_object_; }
  const BodyState& state() const { return state_; }  ///< state of the centre of mass, world

  /// Moves the object to a pose without a motion; its velocities do not change.
  void put(const Pose& T_world_com);
  /// Applies a wrench about the centre of mass for the next step.
  void push(const Wrench&);
  /// Reads the state after a step.
  void read();

 private:
  StartObject start_;
  btDynamicsWorld& world_;
  std::unique_ptr<btRigidBody> body_;
  double min_inertia_{};
  Pose T_world_object_{Pose::Identity()};
  BodyState state_;
};

}  // namespace handsel::sim
