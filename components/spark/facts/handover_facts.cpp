// SPDX-License-Identifier: Apache-2.0
#include "components/spark/facts/handover_facts.hpp"

#include <algorithm>
#include <cmath>

#include "common/cost/human_cost.hpp"
#include "common/cost/person_frame.hpp"
#include "components/spark/directed.hpp"

namespace handsel::spark {
namespace {

/// Returns the distance of the hand in front of its shoulder, divided by the length of the arm.
double stretch(const Person& person, Side side) {
  const bool left = side == Side::left;
  const Vector3 from_shoulder = joint_of(person, left ? "l_hand" : "r_hand").position -
                                joint_of(person, left ? "l_shoulder" : "r_shoulder").position;
  return from_shoulder.dot(torso_axes(person).col(0)) / std::max(0.1, arm_length(person));
}

Side nearer_hand(const Person& person, const Vector3& p) {
  return (joint_of(person, "l_hand").position - p).norm() <
                 (joint_of(person, "r_hand").position - p).norm()
             ? Side::left
             : Side::right;
}

}  // namespace

std::set<std::string> HandoverFacts::holders(const SceneObject& object) {
  std::set<std::string> now;
  const std::set<std::string>& before = holders_[object.id];
  for (const ObjectGrip& grip : object.grips)
    if (!grip.person.empty() &&
        grip.force > (before.count(grip.person) ? settings_.grip_lost : settings_.grip_force))
      now.insert(grip.person);
  if (object.grips.empty() && object.holder == Holder::human) now.insert(object.holder_id);
  if (object.grips.empty() && object.holder == Holder::robot) now.insert(kRobotName);
  return now;
}

void HandoverFacts::held_and_released(const SceneObject& object, TimePoint now,
                                      std::vector<Candidate>& out) {
  const std::set<std::string> hold = holders(object), before = holders_[object.id];
  for (const std::string& holder : hold) {
    const auto grip = std::find_if(object.grips.begin(), object.grips.end(),
                                   [&](const ObjectGrip& g) { return g.person == holder; });
    const bool robot = holder == kRobotName;
    out.push_back({robot ? FactKind::held_by_robot : FactKind::held_by_human, object.id,
                   robot ? "" : holder, 1, true, true,
                   grip != object.grips.end() ? evidence("grip %.1f N", grip->force)
                   : robot                    ? "load on the hand that is there"
                                              : "in the hand, on nothing else"});
  }
  for (const std::string& holder : before)
    if (!hold.empty() && !hold.count(holder))
      released_[{object.id, holder}] = {now, "released while " + *hold.begin() + " holds it"};
  for (const std::string& holder : hold) released_.erase({object.id, holder});
  holders_[object.id] = hold;
}

void HandoverFacts::offered(const SceneObject& object, const HumanState& people,
                            const RobotPartner& robot, TimePoint now, std::vector<Candidate>& out) {
  for (const Person& giver : people.people) {
    if (!holders_[object.id].count(giver.id)) continue;
    const BodyJoint& torso = joint_of(giver, "torso");
    const auto level = [](const Vector3& v) { return Vector3(v.x(), v.y(), 0).stableNormalized(); };
    const Vector3 held = level(object.T_world_object.translation() - torso.position);
    Vector3 partner = robot.body;
    std::string receiver = kRobotName;
    // Cosine of the angle to the receiver.
    double cosine = held.dot(level(robot.body - torso.position));
    for (const Person& other : people.people) {
      const Vector3& p_other = joint_of(other, "torso").position;
      const double cosine_to_other = held.dot(level(p_other - torso.position));
      if (other.id == giver.id || cosine_to_other < cosine ||
          (p_other - torso.position).norm() > settings_.offer_range)
        continue;
      partner = p_other;
      receiver = other.id;
      cosine = cosine_to_other;
    }
    const double away = (partner - object.T_world_object.translation()).norm();
    const double toward = speed_toward(object.T_world_object.translation(),
                                       object.velocity - torso.velocity, partner);
    const bool near = away < settings_.offer_range;
    const bool is_changing_hands =
        holders_[object.id].size() > 1 ||
        std::any_of(released_.begin(), released_.end(),
                    [&](const auto& r) { return r.first.first == object.id; });
    const bool is_at_rest_offer =
        !is_changing_hands && std::abs(toward) < settings_.offer_speed &&
        cosine > settings_.min_offer_cosine &&
        stretch(giver, nearer_hand(giver, object.T_world_object.translation())) >
            settings_.stretched;
    const bool begins = near && (toward > settings_.offer_speed || is_at_rest_offer);
    const bool back = toward < -settings_.offer_speed;
    const Pair pair{giver.id, object.id};
    const std::string seen =
        evidence("toward %.40s at %.2f m/s, %.2f m away", receiver.c_str(), toward, away);
    out.push_back({FactKind::offering, giver.id, object.id, toward, begins, near && !back, seen});
    const bool was_offering = offering_.count(pair) > 0;
    if (begins || (was_offering && !back)) {
      offering_[pair] = now;
    } else if (was_offering) {
      withdrawn_[pair] = {now, seen};
      offering_.erase(pair);
    }
  }
}

void HandoverFacts::reached_for(const Person& person, const std::string& target,
                                const Vector3& p_world, TimePoint now,
                                std::vector<Candidate>& out) {
  const BodyJoint& torso = joint_of(person, "torso");
  double toward = -1e9, distance = 0, back = 1e9;
  for (const char* side : {"l_hand", "r_hand"}) {
    const BodyJoint& hand = joint_of(person, side);
    if ((p_world - hand.position).norm() > arm_length(person) + settings_.max_beyond_arm) continue;
    const double speed = speed_toward(hand.position, hand.velocity - torso.velocity, p_world);
    back = std::min(back, speed);
    if (speed <= toward) continue;
    toward = speed;
    distance = (p_world - hand.position).norm();
  }
  const Pair pair{person.id, target};
  if (toward > -1e9)
    out.push_back({FactKind::reaching, person.id, target, toward, toward > settings_.reach_speed,
                   toward > settings_.reach_speed / 3,
                   evidence("hand at %.2f m/s, %.2f m away", toward, distance)});
  if (toward > settings_.reach_speed)
    reaching_[pair] = now;
  else if (const auto reached = reaching_.find(pair);
           reached != reaching_.end() && back < -settings_.reach_speed) {
    if (to_seconds(now - reached->second) < settings_.memory)
      withdrawn_[pair] = {now, evidence("hand back at %.2f m/s", -back)};
    reaching_.erase(reached);
  }
}

void HandoverFacts::waited_for(const Person& person, const Scene& scene,
                               std::vector<Candidate>& out) {
  double max_stretch = 0, speed = 0;
  Vector3 hand = Vector3::Zero();
  for (const Side side : {Side::left, Side::right}) {
    const BodyJoint& h = joint_of(person, side == Side::left ? "l_hand" : "r_hand");
    const double forward = stretch(person, side);
    if (forward <= max_stretch) continue;
    max_stretch = forward;
    hand = h.position;
    speed = (h.velocity - joint_of(person, "torso").velocity).norm();
  }
  for (const SceneObject& object : scene.objects) {
    const std::set<std::string>& hold = holders_[object.id];
    const double distance = (object.T_world_object.translation() - hand).norm();
    if (hold.empty() || hold.count(person.id) || distance > arm_length(person)) continue;
    const bool waits = max_stretch > settings_.stretched && speed < settings_.reach_speed;
    const bool still = max_stretch > 0.9 * settings_.stretched && speed < 3 * settings_.reach_speed;
    out.push_back({FactKind::waiting_to_receive, person.id, object.id, distance, waits, still,
                   evidence("hand stretched out %.0f %%, %.2f m from it, at %.2f m/s",
                            100 * max_stretch, distance, speed)});
  }
}

/// Deletes the memory of objects and people that are absent, and of events that are over.
void HandoverFacts::forget(const Scene& scene, const HumanState& people, TimePoint now) {
  std::set<std::string> known_ids{kRobotName};
  for (const SceneObject& object : scene.objects) known_ids.insert(object.id);
  std::erase_if(holders_, [&](const auto& entry) { return !known_ids.contains(entry.first); });
  for (const Person& person : people.people) known_ids.insert(person.id);
  const auto over = [&](const auto& entry) {
    return to_seconds(now - entry.second) > settings_.memory &&
           (!known_ids.contains(entry.first.first) || !known_ids.contains(entry.first.second));
  };
  std::erase_if(offering_, over);
  std::erase_if(reaching_, over);
}

void HandoverFacts::find(const Scene& scene, const HumanState& people, const RobotPartner& robot,
                         TimePoint now, std::vector<Candidate>& out) {
  forget(scene, people, now);
  for (const SceneObject& object : scene.objects) held_and_released(object, now, out);
  for (const SceneObject& object : scene.objects) offered(object, people, robot, now, out);
  for (const Person& person : people.people) {
    if (std::any_of(scene.objects.begin(), scene.objects.end(),
                    [&](const SceneObject& o) { return holders_[o.id].count(person.id) > 0; }))
      std::erase_if(reaching_, [&](const auto& reached) {
        return reached.first.first == person.id;
      });  // the hand returns with an object
    for (const SceneObject& object : scene.objects)
      if (!holders_[object.id].count(person.id))
        reached_for(person, object.id, object.T_world_object.translation(), now, out);
    reached_for(person, kRobotName, robot.tool, now, out);
    waited_for(person, scene, out);
  }
  const auto add_events = [&](FactKind kind, std::map<Pair, Moment>& moments) {
    std::erase_if(moments,
                  [&](const auto& m) { return to_seconds(now - m.second.at) > settings_.memory; });
    for (const auto& [pair, moment] : moments)
      out.push_back({kind, pair.first, pair.second, 1, true, true, moment.evidence});
  };
  add_events(FactKind::released, released_);
  add_events(FactKind::withdrawn, withdrawn_);
}

}  // namespace handsel::spark
