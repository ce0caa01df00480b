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
                       btDynamicsWorld& world, int group, int mask)
    : settings_(settings),
      world_(world),
      spring_(spring_of(settings)),
      shape_(std::make_unique<btSphereShape>(settings.radius)) {
  btRigidBody::btRigidBodyConstructionInfo info(
      settings.mass, nullptr, shape_.get(),
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
