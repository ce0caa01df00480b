// SPDX-License-Identifier: Apache-2.0
// The robot as a Featherstone multibody with joint servos, for any RobotModel; links connected by
// fixed joints become one body.
#pragma once

#include <memory>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "common/model/robot_model.hpp"
#include "sim/physics/bullet.hpp"

namespace handsel::sim {

/// Arm and head use computed torque, so gravity causes no position error. Joints of the hand
/// (beyond the tool's body) use impedance control, so a finger stopped by an object presses with a
/// torque proportional to the distance from the reference. Both respect the torque limits. A
/// coupled joint has no motor: a stiff spring couples the joint to its leader in both directions.
struct ServoSettings {
  double bandwidth{60.0};  ///< bandwidth of the computed-torque loop [rad/s]
  /// Max bandwidth of a free finger [rad/s]; below the physics rate.
  double finger_bandwidth{600};
  /// Distance from the reference at which a finger applies its max torque [rad] (1/100 of it in m).
  double finger_travel{0.1};
  double rotor_inertia{1e-4};  ///< of a finger joint's motor at the joint side of the gear [kg m^2]
  double default_effort{50.0};  ///< effort limit without one in the model [Nm]
};

/// Properties of the finger pads.
struct PadSettings {
  double friction{1.0};  ///< friction coefficient divided by the object's coefficient
  /// Max torque about the normal per newton of friction: radius of the contact patch [m].
  double patch{0.005};
  double stiffness{2e4};  ///< contact stiffness [N/m]
  double damping{60};     ///< contact damping [N s/m]
};

/// The physics world of a body, and the bodies with which it collides.
struct BodyWorld {
  btMultiBodyDynamicsWorld& dynamics;  ///< Must outlive the body.
  ShapeStore& shapes;                  ///< Owns the collision shapes; must outlive the body.
  int collision_group{};               ///< Bullet collision group of the links.
  int collision_mask{};                ///< Groups that the links collide with.
};

class RobotBody {
 public:
  RobotBody(const RobotModel&, const Pose& T_world_base, const Vector& start, const ServoSettings&,
            const PadSettings&, const BodyWorld&);
  ~RobotBody();

  /// Sets the references of all axes for the next step; `effort` is added to the servo efforts.
  /// Coupled joints follow their axis.
  void drive(const Vector& position, const Vector& velocity, const Vector& acceleration,
             const Vector& effort);
  /// Applies a wrench to the body at a world point for the next step.
  void push(int body, const Vector3& point, const Wrench&);
  /// Reads the state after a step.
  void read();

  const Vector& position() const { return q_; }   ///< all axes
  const Vector& velocity() const { return qd_; }  ///< all axes [rad/s] ([m/s])
  /// Returns the efforts of all axes, with gravity, friction and contacts [Nm] ([N]).
  const Vector& effort() const { return effort_; }
  /// Returns the pose of a link as of the last read(); no check of the index.
  const Pose& T_world_link(int link) const { return T_world_link_[link]; }
  /// Returns the poses of all links of the model, in its order, as of the last read().
  const std::vector<Pose>& T_world_links() const { return T_world_link_; }
  Vector3 point_velocity(int body, const Vector3& point) const;    ///< world
  Vector3 angular_velocity(int body) const;                        ///< world
  int body_of(int link) const { return body_of_link_[link]; }      ///< -1: the base
  int bodies() const { return static_cast<int>(bodies_.size()); }  ///< number of moving bodies
  int parent_of(int body) const { return bodies_[body].parent; }   ///< -1: the base
  /// Returns the name of the link that the body's joint moves; for -1 the root link.
  const std::string& name_of(int body) const;
  /// Adds the axis torques equivalent to a world wrench at `point` of `body`.
  void project(int body, const Vector3& point, const Wrench&, Vector& torque) const;
  /// Writes the derivative of the point's position along n by each axis.
  void directed_jacobian(int body, const Vector3& point, const Vector3& n, Vector& out) const;
  /// Returns Bullet's collision object of the body; nullptr if the body has no collision shapes.
  btMultiBodyLinkCollider* collider(int body) { return bodies_[body].collider.get(); }

 private:
  struct Body {
    int link{}, parent{-1}, dof{-1};
    int leader{-1};  // body of the leading joint; -1: the joint has a motor
    bool prismatic{false};
    double factor{1}, offset{0}, limit{0};
    Pose T_parent_pivot{Pose::Identity()};  // this body's frame in the parent body's at q = 0
    Vector3 axis{Vector3::UnitZ()};
    double mass{0};
    Vector3 com{Vector3::Zero()};
    Eigen::Matrix3d inertia{Eigen::Matrix3d::Zero()};
    Eigen::Matrix3d R_body_principal{Eigen::Matrix3d::Identity()};
    std::unique_ptr<btMultiBodyLinkCollider> collider;
    Pose T_world{Pose::Identity()};
    Vector3 omega{Vector3::Zero()}, v{Vector3::Zero()};  // of the frame's origin, world
    int finger{-1};                   // index of the chain beyond the tool's body
    double stiffness{0}, damping{0};  // of a finger joint's motor or coupling
    double torque{0};
  };

  static bool is_coupled(const Body& b) { return b.leader >= 0 && b.finger >= 0; }
  void merge_links(const RobotModel&);
  void find_fingers();
  void add_colliders(const BodyWorld&);
  void forward();
  void set_finger_stiffness();
  Eigen::MatrixXd mass_matrix(const std::vector<int>& bodies);
  void inverse_dynamics(const std::vector<double>& acceleration);  // by body; writes Body::torque

  const RobotModel& model_;
  ServoSettings settings_;
  btMultiBodyDynamicsWorld& world_;
  Pose T_world_base_;
  std::vector<Body> bodies_;
  std::vector<int> body_of_link_;
  std::vector<Pose> T_body_link_, T_world_link_;
  std::unique_ptr<btMultiBody> multibody_;
  Vector q_, qd_, effort_;
  std::vector<double> commanded_acceleration_;
  std::vector<Vector3> force_, moment_, alpha_, acc_;  // scratch of the inverse dynamics
};

}  // namespace handsel::sim
