// SPDX-License-Identifier: Apache-2.0
#include "components/attention/looks.hpp"

#include <algorithm>

#include "common/model/human/body_index.hpp"

namespace handsel::attention {

bool robot_known(const World& w, const Body& body) {
  return w.active && w.active->position.size() == body.dof();
}
bool doing(const World& w, ActionKind kind) {
  return w.action && w.action->state == ActionState::running && w.action->kind == kind;
}

const Person* person_of_interest(const World& w, const Vector3& p, double lost_after) {
  if (!w.people) return nullptr;
  const Person* best = nullptr;
  double nearest = kInfinity;
  for (const Person& person : w.people->people) {
    if (person.joints.size() != kBodyJoints.size() || person.age > lost_after) continue;
    if (w.action && !w.action->human.empty() && w.action->human == person.id) return &person;
    const double d = (person.joints[body::torso].position - p).norm();
    if (d < nearest) {
      nearest = d;
      best = &person;
    }
  }
  return best;
}

bool holds(const World& w, FactKind kind, const std::string& person) {
  return w.facts && std::any_of(w.facts->facts.begin(), w.facts->facts.end(), [&](const Fact& f) {
           return f.kind == kind && (person.empty() || f.subject == person);
         });
}

bool attentive(const World& w, const std::string& person) {
  return !w.facts || holds(w, FactKind::attentive, person);
}

NearHand nearest_hand(const Person& person, const Vector3& p) {
  NearHand near;
  for (std::size_t j : {std::size_t{7}, std::size_t{11}}) {
    const double d = (person.joints[j].position - p).norm();
    if (d < near.distance) near = {d, person.joints[j].position, person.joints[j].velocity};
  }
  return near;
}

namespace {

/// Returns whether a hand is extended toward the robot and at rest.
bool is_extended(const Person& person, Side side, const Vector3& p_robot,
                 const MotorSettings& motor) {
  const bool left = side == Side::left;
  const BodyJoint& hand = person.joints[left ? body::l_hand : body::r_hand];
  const Vector3& shoulder = person.joints[left ? body::l_shoulder : body::r_shoulder].position;
  const Vector3 toward = (p_robot - shoulder).cwiseProduct(Vector3(1, 1, 0)).stableNormalized();
  return (hand.position - shoulder).dot(toward) >= motor.shift_extension &&
         hand.velocity.norm() <= motor.shift_speed;
}

}  // namespace

std::optional<Vector3> shift_to_extended_hand(const ActionStatus& action, const Person& person,
                                              const Vector3& p_robot, const MotorSettings& motor) {
  if (action.has_partner) {
    if (!is_extended(person, action.partner_side, p_robot, motor)) return std::nullopt;
    const auto wrist = action.partner_side == Side::left ? body::l_wrist : body::r_wrist;
    return person.joints[wrist].position - action.T_world_partner_wrist.translation();
  }
  std::optional<Vector3> nearest;
  for (const Side side : {Side::right, Side::left}) {
    if (!is_extended(person, side, p_robot, motor)) continue;
    const auto hand = side == Side::left ? body::l_hand : body::r_hand;
    const Vector3 to_hand = person.joints[hand].position - action.exchange_point;
    const double distance = to_hand.norm();
    if (distance > motor.hand_to_object &&
        (!nearest || distance - motor.hand_to_object < nearest->norm()))
      nearest = (1 - motor.hand_to_object / distance) * to_hand;
  }
  return nearest;
}

double urgency(double distance, double closing, double urgent_speed) {
  return std::max(0.0, closing > urgent_speed ? distance * urgent_speed / closing : distance);
}

double ramp(double x, double low, double high) {
  return std::clamp((x - low) / (high - low), 0.0, 1.0);
}

bool in_handover_with(const World& w, const std::string& person) {
  if (doing(w, ActionKind::pick)) return w.action->human == person && !person.empty();
  return (doing(w, ActionKind::give) || doing(w, ActionKind::receive)) &&
         (w.action->human.empty() || w.action->human == person);
}

SeparationExemption handover_exemption(const World& w) {
  SeparationExemption exception;
  if (!w.action || !w.action->exchange_engaged) return exception;
  exception.person = w.action->human;
  if (exception.person.empty() && w.people && w.people->people.size() == 1)
    exception.person = w.people->people.front().id;
  return exception;
}

}  // namespace handsel::attention
