// The robot as a Featherstone multibody under joint servos: any RobotModel; links joined by fixed
// joints become one body.
#pragma once

#include <memory>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "common/model/robot_model.hpp"
#include "sim/physics/bullet.hpp"

namespace handsel::sim {

/// Arm and head: computed torque, so that the references are followed without sag. Joints of the
/// hand (beyond the tool's body): impedance, so that a finger stopped by an object presses with a
/// torque that grows with the distance to its reference. Both within the torque limits. A coupled
/// joint has no motor: a stiff spring ties it to the joint it follows, which feels it.
struct ServoSettings {
  double bandwidth{60.0};  ///< of the computed-torque loop [rad/s]
  /// Of the fastest motion of a free finger [rad/s]; below the physics rate.
  double finger_bandwidth{600};
  /// A finger presses with its whole torque at this distance [rad] (a hundredth of it in m).
  double finger_travel{0.1};
  double rotor_inertia{1e-4};   ///< of a finger joint's motor, seen through its gear [kg m^2]
  double default_effort{50.0};  ///< where the model gives none [Nm]
};

/// What the fingers are covered with.
struct PadSettings {
  double friction{1.0};  ///< times the object's coefficient
  /// Torque about the normal per newton of friction at rest: the radius of the patch [m].
  double patch{0.005};
  double stiffness{2e4};  ///< of the pad [N/m]
  double damping{60};     ///< [N s/m]
};

/// The physics world that a body is part of, and what the body collides with there.
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

  /// Set-points of all axes for the coming step; efforts are added to what the servos give. Coupled
  /// joints follow their axis.
  void drive(const Vector& position, const Vector& velocity, const Vector& acceleration,
             const Vector& effort);
  /// Wrench on the body at a world point, for the coming step.
  void push(int body, const Vector3& point, const Wrench&);
  /// Reads the state after a step.
  void read();

  const Vector& position() const { return q_; }   ///< all axes
  const Vector& velocity() const { return qd_; }  ///< all axes [rad/s] ([m/s])
  /// Gravity, friction and contacts included [Nm].
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
  /// Returns the name of the link that the body's joint moves; of the root link for -1.
  const std::string& name_of(int body) const;
  /// Adds the axis torques that a world wrench at `point` of `body` amounts to.
  void project(int body, const Vector3& point, const Wrench&, Vector& torque) const;
  /// Columns of the point's linear Jacobian along direction n, one an axis.
  void directed_jacobian(int body, const Vector3& point, const Vector3& n, Vector& out) const;
  /// Returns Bullet's collision object of the body; nullptr if the body has no collision shapes.
  btMultiBodyLinkCollider* collider(int body) { return bodies_[body].collider.get(); }

 private:
  struct Body {
    int link{}, parent{-1}, dof{-1};
    int leader{-1};  // body whose joint this one's is coupled to; -1: it has a motor
    bool prismatic{false};
    double factor{1}, offset{0}, limit{0};
    Pose T_parent_pivot{Pose::Identity()};  // parent body frame to this one's at q = 0
    Vector3 axis{Vector3::UnitZ()};
    double mass{0};
    Vector3 com{Vector3::Zero()};
    Eigen::Matrix3d inertia{Eigen::Matrix3d::Zero()};
    Eigen::Matrix3d R_body_principal{Eigen::Matrix3d::Identity()};
    std::unique_ptr<btMultiBodyLinkCollider> collider;
    Pose T_world{Pose::Identity()};
    Vector3 omega{Vector3::Zero()}, v{Vector3::Zero()};  // of the frame origin, world
    int finger{-1};                                      // which chain beyond the tool's body
    double stiffness{0}, damping{0};  // of a finger joint's motor, or of its coupling
    double torque{0};
  };

  static bool follows(const Body& b) { return b.leader >= 0 && b.finger >= 0; }
  void lump(const RobotModel&);
  void find_fingers();
  void add_colliders(const BodyWorld&);
  void forward();
  void soften_fingers();
  Eigen::MatrixXd mass_matrix(const std::vector<int>& bodies);
  void inverse_dynamics(const std::vector<double>& acceleration);  // by body; fills Body::torque

  const RobotModel& model_;
  ServoSettings settings_;
  btMultiBodyDynamicsWorld& world_;
  Pose T_world_base_;
  std::vector<Body> bodies_;
  std::vector<int> body_of_link_;
  std::vector<Pose> T_body_link_, T_world_link_;
  std::unique_ptr<btMultiBody> multibody_;
  Vector q_, qd_, effort_;
  std::vector<double> wanted_;
  std::vector<Vector3> force_, moment_, alpha_, acc_;  // scratch of the inverse dynamics
};

}  // namespace handsel::sim
