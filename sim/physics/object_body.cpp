// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/object_body.hpp"

#include <algorithm>

#include "common/base/errors.hpp"
#include "sim/physics/contacts.hpp"

namespace handsel::sim {

ObjectBody::ObjectBody(const StartObject& start, int index, ShapeStore& shapes,
                       btDynamicsWorld& world)
    : start_(start), world_(world) {
  Pose T_com_object = Pose::Identity();
  T_com_object.translation() = -model().com;
  btCollisionShape* shape = shapes.combine(model().solids(), T_com_object);
  if (shape == nullptr)
    throw ConfigError("object " + start.id + " of model " + start.model_name +
                      " has no parts to collide with");
  btVector3 inertia(0, 0, 0);
  shape->calculateLocalInertia(model().mass, inertia);
  btRigidBody::btRigidBodyConstructionInfo info(model().mass, nullptr, shape, inertia);
  info.m_startWorldTransform = to_bt(Pose(start.T_world_object * T_com_object.inverse()));
  info.m_friction = model().friction;
  info.m_rollingFriction = 0;
  info.m_linearDamping = 0;
  info.m_angularDamping = 0.02;
  body_ = std::make_unique<btRigidBody>(info);
  body_->setActivationState(DISABLE_DEACTIVATION);
  min_inertia_ = std::min({inertia.x(), inertia.y(), inertia.z()});
  own(*body_, Owner::object, index);
  world_.addRigidBody(body_.get(), kObject, kRobot | kFixed | kObject);
  read();
}

ObjectBody::~ObjectBody() { world_.removeRigidBody(body_.get()); }

void ObjectBody::put(const Pose& T_world_com) {
  body_->setWorldTransform(to_bt(T_world_com));
  body_->setInterpolationWorldTransform(body_->getWorldTransform());
  read();
}

void ObjectBody::push(const Wrench& wrench) {
  body_->applyCentralForce(to_bt(wrench.force));
  body_->applyTorque(to_bt(wrench.torque));
}

void ObjectBody::read() {
  state_ = {from_bt(body_->getWorldTransform()), from_bt(body_->getLinearVelocity()),
            from_bt(body_->getAngularVelocity())};
  T_world_object_ = state_.T_world_body;
  T_world_object_.translation() -= T_world_object_.linear() * model().com;
}

}  // namespace handsel::sim
