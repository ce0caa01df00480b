// SPDX-License-Identifier: Apache-2.0
// The robot's hands in the emulated world: grasps, and the reports of hands and robot.
#include <algorithm>
#include <cmath>

#include "sim/world_parts.hpp"

namespace handsel::sim {

namespace {

constexpr double kGravity = 9.81;           // acceleration of gravity [m/s^2]
constexpr double kMaxConstraintMass = 1.0;  // max mass that a grasp constraint helps to hold [kg]

}  // namespace

BodyState SimWorld::Impl::tool_state(const Hand& hand) const {
  BodyState s;
  if (hand.palm < 0) return s;
  s.T_world_body = robot->T_world_link(hand.palm);
  s.velocity = robot->point_velocity(robot->body_of(hand.palm), s.T_world_body.translation());
  s.angular_velocity = robot->angular_velocity(robot->body_of(hand.palm));
  return s;
}

void SimWorld::Impl::update_robot_hands() {
  robot_parts.clear();
  for (const LinkCapsule& c : links) {
    const Pose& T = robot->T_world_link(c.link);
    robot_parts.push_back({T * c.a, T * c.b, c.radius});
  }
  robot_hands.resize(hands.size());
  for (std::size_t i = 0; i < hands.size(); ++i) {
    RobotHandState& seen = robot_hands[i];
    seen.palm = tool_state(hands[i]);
    seen.gripped = hands[i].gripped;
    seen.holds_firmly = holds_firmly(hands[i]);
    seen.pressed = hands[i].pressed;
    seen.fingers.clear();
    for (std::size_t k = 0; k < links.size(); ++k) {
      if (hands[i].grasp.chain_of(robot->body_of(links[k].link)) >= 1)
        seen.fingers.push_back(robot_parts[k]);
    }
  }
}

void SimWorld::Impl::hold_with(Hand& hand) {
  if (hand.gripped < 0 || !helped(hand.gripped)) return;
  ObjectBody& object = objects[hand.gripped];
  const Wrench w = hand.grip.update(tool_state(hand), object.state(), object.model().mass,
                                    object.min_inertia(), settings.step);
  if (!hand.grip.holding()) {
    release(hand);
    return;
  }
  object.push(w);
  robot->push(hand.grasp.palm(), object.state().T_world_body.translation(), {-w.force, -w.torque});
}

void SimWorld::Impl::release(Hand& hand) {
  hand.grip.release();
  hand.grasp.reset();
  hand.gripped = -1;
}

/// Returns whether the grasp constraint acts on the object. Contacts alone hold heavy objects: a
/// spring in proportion to their mass is too stiff for hand and wrist at the physics step.
bool SimWorld::Impl::helped(int object) const {
  return settings.constraint && objects[object].model().mass <= kMaxConstraintMass;
}

/// Returns whether the friction of all hands on this hand's object bears its weight.
bool SimWorld::Impl::holds_firmly(const Hand& hand) const {
  if (hand.gripped < 0 || hand.grip.holding()) return hand.gripped >= 0;
  const ObjectModel& object = objects[hand.gripped].model();
  double pressure = 0;
  for (const Hand& one : hands)
    if (one.gripped == hand.gripped) pressure += one.grasp.pressure(touches, one.gripped);
  return pressure * object.friction >= object.mass * kGravity;
}

bool SimWorld::Impl::grips(int object) const {
  return std::any_of(hands.begin(), hands.end(),
                     [&](const Hand& hand) { return hand.gripped == object; });
}

bool SimWorld::Impl::grips_something() const {
  return std::any_of(hands.begin(), hands.end(),
                     [](const Hand& hand) { return hand.gripped >= 0; });
}

bool SimWorld::Impl::of_hand(int body) const {
  return std::any_of(hands.begin(), hands.end(),
                     [&](const Hand& hand) { return hand.grasp.chain_of(body) >= 0; });
}

void SimWorld::Impl::update_grasp(Hand& hand) {
  int candidate = hand.gripped;
  if (candidate < 0) {
    double max_pressure = 0;
    for (int i = 0; i < static_cast<int>(objects.size()); ++i) {
      const double pressure = hand.grasp.pressure(touches, i);
      if (pressure > max_pressure) max_pressure = pressure, candidate = i;
    }
    hand.pressed = max_pressure > settings.touch_force ? candidate : -1;
  }
  const Vector3 centre = candidate < 0 ? Vector3(Vector3::Zero())
                                       : objects[candidate].state().T_world_body.translation();
  const bool held = hand.grasp.update(touches, candidate, centre, settings.step);
  if (hand.gripped < 0 && held) {
    hand.gripped = hand.pressed = candidate;
    if (helped(candidate))
      hand.grip.hold(tool_state(hand).T_world_body.inverse() *
                     objects[candidate].state().T_world_body);
  } else if (hand.gripped >= 0 && !held) {
    release(hand);
  }
}

void SimWorld::Impl::update_grasps() {
  for (Hand& hand : hands) update_grasp(hand);
  if (!grips_something()) return;
  held_time += settings.step;
  double by_constraints = 0, by_contacts = 0;
  for (const Hand& hand : hands) {
    if (hand.gripped < 0) continue;
    if (hand.grip.holding()) by_constraints += hand.grip.wrench().force.norm();
    by_contacts += hand.grasp.force(touches, hand.gripped).norm();
  }
  constraint_carries = by_constraints > by_contacts;
  if (constraint_carries) constraint_time += settings.step;
}

void SimWorld::Impl::measure(Hand& hand) {
  Wrench load;
  Vector3 at = Vector3::Zero();
  if (hand.gripped >= 0 && hand.grip.holding()) {
    load = {-hand.grip.wrench().force, -hand.grip.wrench().torque};
    at = objects[hand.gripped].state().T_world_body.translation();
  }
  hand.measured.update(touches, *robot, hand.grasp, tool_state(hand).T_world_body, load, at);
}

bool SimWorld::robot_state(RobotState& out) {
  Impl& w = *impl_;
  if (w.now() < w.state_silent_until) return false;
  out.robot = w.model.name();
  out.sequence = ++w.state_sequence;
  out.T_world_base = w.setup.T_world_base;
  if (w.odometry) {
    out.T_world_base = w.setup.T_world_base * w.odometry->T_root_odometry();
    out.localisation_age = w.odometry->age(w.now());
  }
  out.position = w.measured_position();
  for (Eigen::Index i = 0; i < out.position.size(); ++i)
    out.position[i] += w.noise(w.settings.position_noise);
  out.velocity =
      w.odometry ? w.odometry->measured_velocity(w.robot->velocity()) : w.robot->velocity();
  out.effort = w.robot->effort();
  w.side.report(out.reference);
  out.external_torque = w.hands.front().measured.external_torque();
  for (std::size_t i = 1; i < w.hands.size(); ++i)
    out.external_torque += w.hands[i].measured.external_torque();
  for (std::size_t i = 0; i < w.hands.size(); ++i) {
    const Impl::Hand& hand = w.hands[i];
    if (!(w.side.payload(i) > 0) || hand.palm < 0)
      continue;  // the commanded payload is part of the robot's own model
    const Wrench weight{Vector3(0, 0, kGravity * w.side.payload(i)), Vector3::Zero()};
    w.robot->project(w.robot->body_of(hand.palm), w.tool_state(hand).T_world_body.translation(),
                     weight, out.external_torque);
  }
  for (Eigen::Index i = 0; i < out.external_torque.size(); ++i)
    out.external_torque[i] += w.noise(0.1 * w.settings.force_noise);
  const auto write_measurement = [&w](const Impl::Hand& hand, Wrench& wrench, double& effort,
                                      double& payload) {
    wrench = hand.measured.wrist_wrench();
    for (int i = 0; i < 3; ++i) {
      wrench.force[i] += w.noise(w.settings.force_noise);
      wrench.torque[i] += w.noise(0.1 * w.settings.force_noise);
    }
    effort = 0;
    if (hand.fingers != nullptr)
      for (int axis : hand.fingers->axes) effort += std::abs(w.robot->effort()[axis]);
    payload = std::max(0.0, hand.measured.payload());
  };
  write_measurement(w.hands.front(), out.wrist_wrench, out.hand_effort, out.payload);
  out.other_hands.resize(w.hands.size() - 1);
  for (std::size_t i = 1; i < w.hands.size(); ++i) {
    OtherHand& other = out.other_hands[i - 1];
    other.group = w.hands[i].fingers != nullptr ? w.hands[i].fingers->name : "";
    write_measurement(w.hands[i], other.wrist_wrench, other.hand_effort, other.payload);
  }
  out.mode = w.side.mode();
  out.refusal = w.side.refusal();
  out.refused_set_points = w.side.refused();
  return true;
}

}  // namespace handsel::sim
