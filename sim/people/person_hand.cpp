// SPDX-License-Identifier: Apache-2.0
#include "sim/people/person_hand.hpp"

#include <limits>

namespace handsel::sim {

namespace {

GripSettings spring_of(const PersonHandSettings& s) {
  return {.frequency = s.frequency,
          .damping_ratio = 1.0,
          .max_force = s.max_force,
          .max_torque = s.max_torque,
          .break_time = std::numeric_limits<double>::infinity()};
}

}  // namespace

PersonHand::PersonHand(const PersonHandSettings& settings, const BodyState& start,
                       const HumanHand& shape, btDynamicsWorld& world, int group, int mask)
    : settings_(settings),
      world_(world),
      spring_(spring_of(settings)),
      shape_(shape),
      fist_(std::make_unique<btSphereShape>(settings.radius)),
      open_(std::make_unique<btCompoundShape>(false, kHandParts)) {
  for (const HandPart& part : shape_.parts({})) {
    capsules_.push_back(std::make_unique<btCapsuleShapeZ>(part.radius, (part.b - part.a).norm()));
    open_->addChildShape(btTransform::getIdentity(), capsules_.back().get());
  }
  btRigidBody::btRigidBodyConstructionInfo info(
      settings.mass, nullptr, fist_.get(),
      btVector3(settings.inertia, settings.inertia, settings.inertia));
  info.m_startWorldTransform = to_bt(start.T_world_body);
  info.m_friction = settings.friction;
  info.m_linearDamping = info.m_angularDamping = 0;
  body_ = std::make_unique<btRigidBody>(info);
  body_->setActivationState(DISABLE_DEACTIVATION);
  body_->setFlags(body_->getFlags() | BT_DISABLE_WORLD_GRAVITY);  // the arm bears the weight
  world.addRigidBody(body_.get(), group, mask);
  body_->setGravity(btVector3(0, 0, 0));
  spring_.hold(Pose::Identity());
}

PersonHand::~PersonHand() { world_.removeRigidBody(body_.get()); }

BodyState PersonHand::state() const {
  return {from_bt(body_->getWorldTransform()), from_bt(body_->getLinearVelocity()),
          from_bt(body_->getAngularVelocity())};
}

void PersonHand::place(const BodyState& at) {
  body_->setCenterOfMassTransform(to_bt(at.T_world_body));
  body_->setLinearVelocity(to_bt(at.velocity));
  body_->setAngularVelocity(to_bt(at.angular_velocity));
  spring_.hold(Pose::Identity());
}

void PersonHand::set_configuration(const std::optional<HandConfiguration>& configuration) {
  if (!configuration) return use(fist_.get());
  const Pose T_body_hand(state().T_world_body.linear().transpose() *
                         configuration->R_world_hand.toRotationMatrix());
  int child = 0;
  for (const HandPart& part : shape_.parts(configuration->closures)) {
    const Vector3 axis = part.b - part.a;
    const Pose T_hand_part = make_pose((part.a + part.b) / 2,
                                       Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis));
    open_->updateChildTransform(child++, to_bt(T_body_hand * T_hand_part), false);
  }
  open_->recalculateLocalAabb();
  use(open_.get());
}

void PersonHand::use(btCollisionShape* shape) {
  if (body_->getCollisionShape() == shape) return;
  body_->setCollisionShape(shape);
  if (shape == open_.get())
    body_->setContactStiffnessAndDamping(settings_.tissue_stiffness, settings_.tissue_damping);
  else
    body_->setCollisionFlags(body_->getCollisionFlags() &
                             ~btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING);
  // Contacts of the other shape are not those of this one.
  world_.getBroadphase()->getOverlappingPairCache()->cleanProxyFromPairs(
      body_->getBroadphaseHandle(), world_.getDispatcher());
}

void PersonHand::pull_to(const BodyState& wanted, double dt) {
  const Wrench& w = spring_.update(wanted, state(), settings_.mass, settings_.inertia, dt);
  body_->applyCentralForce(to_bt(w.force));
  body_->applyTorque(to_bt(w.torque));
}

void PersonHand::push(const Vector3& point, const Wrench& wrench) {
  body_->applyForce(to_bt(wrench.force), to_bt(point) - body_->getWorldTransform().getOrigin());
  body_->applyTorque(to_bt(wrench.torque));
}

}  // namespace handsel::sim
