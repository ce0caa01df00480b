// SPDX-License-Identifier: Apache-2.0
// A person's hand as a free rigid body: a spring and damper of limited force pull the hand toward
// its commanded pose. A hand that takes an object has a palm and digits, any other hand is a fist.
// Own method: the limit bounds the forces between hand and robot.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/people/taking_hand.hpp"
#include "sim/physics/bullet.hpp"
#include "sim/physics/grip.hpp"

namespace handsel::sim {

struct PersonHandSettings {
  double mass{0.6};         ///< hand and moved part of the forearm [kg]
  double inertia{3e-3};     ///< moment of inertia about any axis [kg m^2]
  double radius{0.045};     ///< radius of the sphere that stands for a fist [m]
  double friction{0.6};     ///< Coulomb coefficient
  double frequency{100.0};  ///< natural frequency of the hand on the spring [rad/s]
  double max_force{60.0};   ///< max force of the spring, hence of the arm [N]
  double max_torque{6.0};   ///< max torque of the spring [Nm]
  /// Stiffness [N/m] and damping [N s/m] of the tissue of palm and digits, each contact.
  double tissue_stiffness{3000.0}, tissue_damping{30.0};
};

class PersonHand {
 public:
  PersonHand(const PersonHandSettings&, const BodyState& start, const HumanHand&, btDynamicsWorld&,
             int group, int mask);
  ~PersonHand();
  PersonHand(const PersonHand&) = delete;
  PersonHand& operator=(const PersonHand&) = delete;

  btRigidBody& body() { return *body_; }          ///< body, for its owner and contact flags
  BodyState state() const;                        ///< state after the last physics step, world
  double mass() const { return settings_.mass; }  ///< [kg]
  /// Returns the last force of the arm on the hand, world [N].
  const Vector3& arm_force() const { return spring_.wrench().force; }
  /// Moves the hand to a pose in no time, with these velocities.
  void place(const BodyState&);
  /// Gives the hand this configuration about its present position; nullopt: a fist.
  void set_configuration(const std::optional<HandConfiguration>&);
  /// Applies the spring's force and torque toward `wanted` for the next step of length dt [s].
  void pull_to(const BodyState& wanted, double dt);
  /// Applies a wrench at a world point for the next step.
  void push(const Vector3& point, const Wrench&);

 private:
  void use(btCollisionShape*);

  PersonHandSettings settings_;
  btDynamicsWorld& world_;
  Grip spring_;
  HumanHand shape_;
  std::unique_ptr<btSphereShape> fist_;
  std::vector<std::unique_ptr<btCapsuleShapeZ>> capsules_;  // in the order of HumanHand::parts()
  std::unique_ptr<btCompoundShape> open_;                   // of the capsules
  std::unique_ptr<btRigidBody> body_;
};

}  // namespace handsel::sim
