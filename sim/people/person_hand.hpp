// A person's hand as a body: free, pulled to where the person wants it by a spring and damper of
// limited force. Own method: keeps the forces between hand and robot limited.
#pragma once

#include <memory>

#include "sim/physics/bullet.hpp"
#include "sim/physics/grip.hpp"

namespace handsel::sim {

struct PersonHandSettings {
  double mass{0.6};         ///< hand and what of the forearm moves with it [kg]
  double inertia{3e-3};     ///< about any axis [kg m^2]
  double radius{0.045};     ///< [m]
  double friction{0.6};     ///< Coulomb coefficient
  double frequency{100.0};  ///< of the hand on its spring [rad/s]
  double max_force{60.0};   ///< of the spring: what the arm pushes or pulls with at most [N]
  double max_torque{6.0};   ///< [Nm]
};

class PersonHand {
 public:
  PersonHand(const PersonHandSettings&, const BodyState& start, btDynamicsWorld&, int group,
             int mask);
  ~PersonHand();
  PersonHand(const PersonHand&) = delete;
  PersonHand& operator=(const PersonHand&) = delete;

  btRigidBody& body() { return *body_; }  ///< for its owner and its contact flags
  BodyState state() const;                ///< as of the last physics step, world
  /// Moves the hand there at once, with these velocities.
  void place(const BodyState&);
  /// Applies force and torque of the spring for the coming step of length dt [s] toward `wanted`.
  void pull_to(const BodyState& wanted, double dt);
  /// Applies a wrench at a world point, for the coming step.
  void push(const Vector3& point, const Wrench&);

 private:
  PersonHandSettings settings_;
  btDynamicsWorld& world_;
  Grip spring_;
  std::unique_ptr<btSphereShape> shape_;
  std::unique_ptr<btRigidBody> body_;
};

}  // namespace handsel::sim
