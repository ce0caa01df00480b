// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/robot_body.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "common/model/manipulator.hpp"

namespace handsel::sim {

namespace {

constexpr double kGravity = 9.81;     // acceleration of gravity [m/s^2]
constexpr double kMinMass = 0.005;    // min mass of a body [kg]
constexpr double kMinInertia = 2e-6;  // min principal inertia of a body [kg m^2]

Eigen::Matrix3d shifted(const Eigen::Matrix3d& inertia, double mass, const Vector3& d) {
  return inertia + mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
}

}  // namespace

RobotBody::RobotBody(const RobotModel& model, const Pose& T_world_base, const Vector& start,
                     const ServoSettings& settings, const PadSettings& pad, const BodyWorld& world)
    : model_(model),
      settings_(settings),
      world_(world.dynamics),
      T_world_base_(T_world_base),
      q_(start) {
  merge_links(model);
  const int n = bodies();
  qd_ = Vector::Zero(model.dof());
  effort_ = Vector::Zero(model.dof());
  force_.resize(n), moment_.resize(n), alpha_.resize(n), acc_.resize(n),
      commanded_acceleration_.resize(n);

  multibody_ = std::make_unique<btMultiBody>(n, 1.0, btVector3(1, 1, 1), true, false);
  multibody_->setBaseWorldTransform(to_bt(T_world_base));
  for (int i = 0; i < n; ++i) {
    Body& b = bodies_[i];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(b.inertia);
    b.R_body_principal = eigen.eigenvectors();
    if (b.R_body_principal.determinant() < 0) b.R_body_principal.col(0) *= -1;
    const Vector3 diagonal = eigen.eigenvalues().cwiseMax(kMinInertia);
    const Eigen::Matrix3d R_parent =
        b.parent < 0 ? Eigen::Matrix3d::Identity() : bodies_[b.parent].R_body_principal;
    const Vector3 com_parent = b.parent < 0 ? Vector3(Vector3::Zero()) : bodies_[b.parent].com;
    const Eigen::Matrix3d R_parent_this =
        R_parent.transpose() * b.T_parent_pivot.linear() * b.R_body_principal;
    const btQuaternion rotation = to_bt(Eigen::Quaterniond(R_parent_this.transpose()));
    const btVector3 axis = to_bt(Vector3(b.R_body_principal.transpose() * b.axis));
    const btVector3 to_pivot =
        to_bt(Vector3(R_parent.transpose() * (b.T_parent_pivot.translation() - com_parent)));
    const btVector3 to_com = to_bt(Vector3(b.R_body_principal.transpose() * b.com));
    if (b.prismatic) {
      multibody_->setupPrismatic(i, b.mass, to_bt(diagonal), b.parent, rotation, axis, to_pivot,
                                 to_com, true);
    } else {
      multibody_->setupRevolute(i, b.mass, to_bt(diagonal), b.parent, rotation, axis, to_pivot,
                                to_com, true);
    }
  }
  multibody_->finalizeMultiDof();
  multibody_->setLinearDamping(0);
  multibody_->setAngularDamping(0);
  multibody_->setHasSelfCollision(false);
  multibody_->setCanSleep(false);
  for (int i = 0; i < n; ++i)
    multibody_->setJointPos(i, bodies_[i].factor * q_[bodies_[i].dof] + bodies_[i].offset);
  world_.addMultiBody(multibody_.get());
  add_colliders(world);
  btAlignedObjectArray<btQuaternion> rotations;
  btAlignedObjectArray<btVector3> origins;
  multibody_->forwardKinematics(rotations, origins);
  multibody_->updateCollisionObjectWorldTransforms(rotations, origins);
  T_world_link_.resize(model.links().size());
  forward();
  set_finger_stiffness();
  for (Body& b : bodies_) {
    if (b.finger < 0 || !b.collider) continue;
    b.collider->setFriction(pad.friction);
    b.collider->setSpinningFriction(pad.patch);
    b.collider->setContactStiffnessAndDamping(pad.stiffness, pad.damping);
  }
}

RobotBody::~RobotBody() {
  for (Body& b : bodies_) {
    if (b.collider) world_.removeCollisionObject(b.collider.get());
  }
  world_.removeMultiBody(multibody_.get());
}

void RobotBody::add_colliders(const BodyWorld& world) {
  for (int i = 0; i < bodies(); ++i) {
    Body& b = bodies_[i];
    std::vector<PlacedShape> parts;
    for (int link = 0; link < static_cast<int>(model_.links().size()); ++link) {
      if (body_of_link_[link] != i) continue;
      for (PlacedShape part : model_.links()[link].collision) {
        part.T_parent_shape = T_body_link_[link] * part.T_parent_shape;
        parts.push_back(part);
      }
    }
    Pose T_principal_body = Pose::Identity();
    T_principal_body.linear() = b.R_body_principal.transpose();
    T_principal_body.translation() = -(b.R_body_principal.transpose() * b.com);
    if (btCollisionShape* shape = world.shapes.combine(parts, T_principal_body)) {
      b.collider = std::make_unique<btMultiBodyLinkCollider>(multibody_.get(), i);
      b.collider->setCollisionShape(shape);
      b.collider->setFriction(1.0);
      world_.addCollisionObject(b.collider.get(), world.collision_group, world.collision_mask);
      multibody_->getLink(i).m_collider = b.collider.get();
    }
  }
}

void RobotBody::merge_links(const RobotModel& model) {
  const auto& links = model.links();
  body_of_link_.assign(links.size(), -1);
  T_body_link_.assign(links.size(), Pose::Identity());
  std::vector<double> mass;
  for (int l = 0; l < static_cast<int>(links.size()); ++l) {
    const Link& link = links[l];
    if (link.parent_joint >= 0) {
      const Joint& joint = model.joints()[link.parent_joint];
      const int parent_body = body_of_link_[joint.parent];
      const Pose T_parent_joint = T_body_link_[joint.parent] * joint.T_parent_joint;
      if (joint.kind == JointKind::fixed || joint.dof < 0) {
        body_of_link_[l] = parent_body;
        T_body_link_[l] = T_parent_joint;
        if (joint.kind == JointKind::prismatic)
          T_body_link_[l].translate(joint.mimic_offset * joint.axis);
        if (joint.kind == JointKind::revolute || joint.kind == JointKind::continuous)
          T_body_link_[l].rotate(Eigen::AngleAxisd(joint.mimic_offset, joint.axis));
      } else {
        Body b;
        b.link = l;
        b.parent = parent_body;
        b.dof = joint.dof;
        b.prismatic = joint.kind == JointKind::prismatic;
        b.factor = joint.is_mimic ? joint.mimic_factor : 1;
        b.offset = joint.is_mimic ? joint.mimic_offset : 0;
        b.limit = joint.max_effort > 0 ? joint.max_effort : model.axes()[joint.dof].max_effort;
        if (b.limit <= 0) b.limit = settings_.default_effort;
        b.T_parent_pivot = T_parent_joint;
        b.axis = joint.axis;
        body_of_link_[l] = bodies();
        bodies_.push_back(std::move(b));
      }
    }
    const int body = body_of_link_[l];
    if (body < 0 || link.mass <= 0) continue;
    Body& b = bodies_[body];
    const Vector3 com = T_body_link_[l] * link.com;
    const Eigen::Matrix3d R = T_body_link_[l].linear();
    const Eigen::Matrix3d about_origin = shifted(R * link.inertia * R.transpose(), link.mass, com);
    b.com = (b.mass * b.com + link.mass * com) / (b.mass + link.mass);
    b.mass += link.mass;
    b.inertia += about_origin;  // about the body's origin until all links are added
  }
  for (Body& b : bodies_) {
    if (!model.joints()[links[b.link].parent_joint].is_mimic) continue;
    for (int i = 0; i < bodies(); ++i) {
      if (links[bodies_[i].link].parent_joint == model.axes()[b.dof].joint) b.leader = i;
    }
  }
  for (Body& b : bodies_) {
    b.inertia -=
        b.mass * (b.com.squaredNorm() * Eigen::Matrix3d::Identity() - b.com * b.com.transpose());
    b.mass = std::max(b.mass, kMinMass);
  }
  find_fingers();
}

void RobotBody::find_fingers() {
  std::vector<char> palm(bodies_.size(), 0);
  for (const Manipulator& hand : hands_of(model_))
    if (hand.palm >= 0 && body_of_link_[hand.palm] >= 0) palm[body_of_link_[hand.palm]] = 1;
  int fingers = 0;
  for (Body& b : bodies_) {
    if (b.parent < 0 || (!palm[b.parent] && bodies_[b.parent].finger < 0)) continue;
    b.finger = palm[b.parent] ? fingers++ : bodies_[b.parent].finger;
    b.inertia += settings_.rotor_inertia * Eigen::Matrix3d::Identity();
  }
}

/// Sets the stiffness of finger joints in proportion to their moved inertia, as high as torque
/// limits and finger bandwidth allow, with Rayleigh damping.
void RobotBody::set_finger_stiffness() {
  std::vector<int> together;  // per finger: representative of its coupled fingers
  for (const Body& b : bodies_)
    if (b.finger >= static_cast<int>(together.size())) together.push_back(b.finger);
  for (const Body& b : bodies_) {
    if (!is_coupled(b)) continue;
    const int from = together[b.finger], to = together[bodies_[b.leader].finger];
    std::replace(together.begin(), together.end(), from, to);
  }
  std::vector<std::vector<int>> fingers(together.size());
  for (int i = 0; i < bodies(); ++i)
    if (bodies_[i].finger >= 0) fingers[together[bodies_[i].finger]].push_back(i);
  const double max_bandwidth = settings_.finger_bandwidth;
  for (const std::vector<int>& finger : fingers) {
    if (finger.empty()) continue;
    const auto n = static_cast<Eigen::Index>(finger.size());
    const Eigen::MatrixXd M = mass_matrix(finger);
    Eigen::MatrixXd K;
    double max_eigenvalue = 2 * max_bandwidth * max_bandwidth;
    for (double stiffness_scale = 1; max_eigenvalue > max_bandwidth * max_bandwidth;
         stiffness_scale *= 0.8) {
      K = Eigen::MatrixXd::Zero(n, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        Body& b = bodies_[finger[i]];
        const auto leader = std::find(finger.begin(), finger.end(), b.leader) - finger.begin();
        b.stiffness = stiffness_scale * M(i, i) * max_bandwidth * max_bandwidth;
        if (!is_coupled(b))
          b.stiffness =
              std::min(b.limit / (settings_.finger_travel * (b.prismatic ? 0.01 : 1)), b.stiffness);
        b.damping = b.stiffness / max_bandwidth;
        Eigen::VectorXd direction = Eigen::VectorXd::Unit(n, i);
        if (is_coupled(b) && leader < n) direction[leader] = -b.factor;
        K += b.stiffness * direction * direction.transpose();
      }
      max_eigenvalue =
          Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(K, M, Eigen::EigenvaluesOnly)
              .eigenvalues()
              .maxCoeff();
    }
  }
}

/// Returns the mass matrix, computed by unit accelerations at rest; differences eliminate gravity.
Eigen::MatrixXd RobotBody::mass_matrix(const std::vector<int>& of) {
  const auto n = static_cast<Eigen::Index>(of.size());
  Eigen::MatrixXd M(n, n);
  std::fill(commanded_acceleration_.begin(), commanded_acceleration_.end(), 0.0);
  inverse_dynamics(commanded_acceleration_);
  Eigen::VectorXd rest(n);
  for (Eigen::Index i = 0; i < n; ++i) rest[i] = bodies_[of[i]].torque;
  for (Eigen::Index k = 0; k < n; ++k) {
    commanded_acceleration_[of[k]] = 1;
    inverse_dynamics(commanded_acceleration_);
    commanded_acceleration_[of[k]] = 0;
    for (Eigen::Index i = 0; i < n; ++i) M(i, k) = bodies_[of[i]].torque - rest[i];
  }
  return (M + M.transpose()) / 2 + 1e-9 * Eigen::MatrixXd::Identity(n, n);
}

void RobotBody::drive(const Vector& position, const Vector& velocity, const Vector& acceleration,
                      const Vector& effort) {
  const double w = settings_.bandwidth;
  for (int i = 0; i < bodies(); ++i) {
    const Body& b = bodies_[i];
    commanded_acceleration_[i] = b.factor * acceleration[b.dof];
    commanded_acceleration_[i] += 2 * w * (b.factor * velocity[b.dof] - multibody_->getJointVel(i));
    if (b.finger >= 0) continue;
    commanded_acceleration_[i] +=
        w * w *
        std::clamp(b.factor * position[b.dof] + b.offset - multibody_->getJointPos(i), -0.1, 0.1);
  }
  inverse_dynamics(commanded_acceleration_);
  for (const Body& b : bodies_) {
    if (is_coupled(b)) bodies_[b.leader].torque += b.factor * b.torque;
  }
  for (int i = 0; i < bodies(); ++i) {
    Body& b = bodies_[i];
    if (is_coupled(b)) continue;
    if (b.finger >= 0) {
      b.torque +=
          b.stiffness * (b.factor * position[b.dof] + b.offset - multibody_->getJointPos(i)) +
          b.damping * (b.factor * velocity[b.dof] - multibody_->getJointVel(i));
    }
    b.torque = std::clamp(b.torque + b.factor * effort[b.dof], -b.limit, b.limit);
    multibody_->addJointTorque(i, b.torque);
  }
  for (int i = 0; i < bodies(); ++i) {
    Body& b = bodies_[i];
    if (!is_coupled(b)) continue;
    const double off =
        b.factor * multibody_->getJointPos(b.leader) + b.offset - multibody_->getJointPos(i);
    const double tie =
        b.stiffness * off +
        b.damping * (b.factor * multibody_->getJointVel(b.leader) - multibody_->getJointVel(i));
    multibody_->addJointTorque(i, tie);
    multibody_->addJointTorque(b.leader, -b.factor * tie);
    b.torque = 0;
  }
}

void RobotBody::push(int body, const Vector3& point, const Wrench& wrench) {
  if (body < 0) return;
  const Vector3 com = bodies_[body].T_world * bodies_[body].com;
  multibody_->addLinkForce(body, to_bt(wrench.force));
  multibody_->addLinkTorque(body,
                            to_bt(Vector3(wrench.torque + (point - com).cross(wrench.force))));
}

void RobotBody::read() {
  for (int i = 0; i < bodies(); ++i) {
    const Body& b = bodies_[i];
    if (model_.axes()[b.dof].joint != model_.links()[b.link].parent_joint) continue;
    q_[b.dof] = multibody_->getJointPos(i);
    qd_[b.dof] = multibody_->getJointVel(i);
  }
  effort_.setZero();
  for (int i = 0; i < bodies(); ++i) {
    const Body& b = bodies_[i];
    effort_[b.dof] += b.factor * b.torque;
  }
  forward();
}

void RobotBody::forward() {
  for (int i = 0; i < bodies(); ++i) {
    Body& b = bodies_[i];
    const Pose T_world_pivot =
        (b.parent < 0 ? T_world_base_ : bodies_[b.parent].T_world) * b.T_parent_pivot;
    const Vector3 w0 = b.parent < 0 ? Vector3(Vector3::Zero()) : bodies_[b.parent].omega;
    const Vector3 v0 =
        b.parent < 0
            ? Vector3(Vector3::Zero())
            : Vector3(bodies_[b.parent].v + w0.cross(T_world_pivot.translation() -
                                                     bodies_[b.parent].T_world.translation()));
    const double q = multibody_->getJointPos(i), qd = multibody_->getJointVel(i);
    const Vector3 axis = T_world_pivot.linear() * b.axis;
    b.T_world = T_world_pivot;
    if (b.prismatic) {
      b.T_world.translation() += q * axis;
      b.omega = w0;
      b.v = v0 + w0.cross(Vector3(q * axis)) + qd * axis;
    } else {
      b.T_world.linear() = T_world_pivot.linear() * Eigen::AngleAxisd(q, b.axis).toRotationMatrix();
      b.omega = w0 + qd * axis;
      b.v = v0;
    }
  }
  for (std::size_t l = 0; l < T_world_link_.size(); ++l) {
    const int body = body_of_link_[l];
    T_world_link_[l] = (body < 0 ? T_world_base_ : bodies_[body].T_world) * T_body_link_[l];
  }
}

/// Solves the Newton-Euler equations in world axes about each body's frame origin, for the present
/// velocities and the commanded accelerations.
void RobotBody::inverse_dynamics(const std::vector<double>& acceleration) {
  for (int i = 0; i < bodies(); ++i) {
    const Body& b = bodies_[i];
    const Vector3 p = b.T_world.translation();
    const Vector3 axis = b.T_world.linear() * b.axis;
    const double qdd = acceleration[i], qd = multibody_->getJointVel(i);
    Vector3 w0 = Vector3::Zero(), alpha0 = Vector3::Zero(), a0 = Vector3(0, 0, kGravity),
            r = Vector3::Zero();
    if (b.parent >= 0) {
      w0 = bodies_[b.parent].omega;
      alpha0 = alpha_[b.parent];
      a0 = acc_[b.parent];
      r = p - bodies_[b.parent].T_world.translation();
    }
    const Vector3 carried = a0 + alpha0.cross(r) + w0.cross(w0.cross(r));
    alpha_[i] = b.prismatic ? alpha0 : Vector3(alpha0 + qdd * axis + w0.cross(Vector3(qd * axis)));
    acc_[i] =
        b.prismatic ? Vector3(carried + qdd * axis + 2 * w0.cross(Vector3(qd * axis))) : carried;
    const Vector3 c = b.T_world.linear() * b.com;
    const Vector3 a_com = acc_[i] + alpha_[i].cross(c) + b.omega.cross(b.omega.cross(c));
    const Eigen::Matrix3d I = b.T_world.linear() * b.inertia * b.T_world.linear().transpose();
    force_[i] = b.mass * a_com;
    moment_[i] = I * alpha_[i] + b.omega.cross(I * b.omega) + c.cross(force_[i]);
  }
  for (int i = bodies() - 1; i >= 0; --i) {
    Body& b = bodies_[i];
    const Vector3 axis = b.T_world.linear() * b.axis;
    b.torque = b.prismatic ? axis.dot(force_[i]) : axis.dot(moment_[i]);
    if (b.parent < 0) continue;
    const Vector3 r = b.T_world.translation() - bodies_[b.parent].T_world.translation();
    force_[b.parent] += force_[i];
    moment_[b.parent] += moment_[i] + r.cross(force_[i]);
  }
}

Vector3 RobotBody::point_velocity(int body, const Vector3& point) const {
  if (body < 0) return Vector3::Zero();
  const Body& b = bodies_[body];
  return b.v + b.omega.cross(point - b.T_world.translation());
}

Vector3 RobotBody::angular_velocity(int body) const {
  return body < 0 ? Vector3(Vector3::Zero()) : bodies_[body].omega;
}

const std::string& RobotBody::name_of(int body) const {
  return model_.links()[body < 0 ? 0 : bodies_[body].link].name;
}

void RobotBody::project(int body, const Vector3& point, const Wrench& wrench,
                        Vector& torque) const {
  for (int i = body; i >= 0; i = bodies_[i].parent) {
    const Body& b = bodies_[i];
    const Vector3 axis = b.T_world.linear() * b.axis;
    const double amount =
        b.prismatic
            ? axis.dot(wrench.force)
            : axis.dot(wrench.torque + (point - b.T_world.translation()).cross(wrench.force));
    torque[b.dof] += b.factor * amount;
  }
}

void RobotBody::directed_jacobian(int body, const Vector3& point, const Vector3& n,
                                  Vector& out) const {
  out.setZero(model_.dof());
  project(body, point, Wrench{n, Vector3::Zero()}, out);
}

}  // namespace handsel::sim
