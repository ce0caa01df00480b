// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/hand/held_object.hpp"

#include <algorithm>
#include <array>

#include "common/model/human/human_body.hpp"
#include "common/model/object_surface.hpp"

namespace handsel::manipulation_planner {
namespace {

using HandPoints = std::array<Vector3, 2>;

/// Returns the middles of the hands of a person (world).
HandPoints hands_of_person(const Person& person) {
  const auto joint = [&](const char* name) {
    return person.joints[static_cast<std::size_t>(body_joint_index(name))].position;
  };
  return {joint("l_hand"), joint("r_hand")};
}

/// Returns whether a hand of the person is within `distance` [m] of a point of the world.
bool has_hand_near(const Person& person, const Vector3& p_world, double distance) {
  const HandPoints hands = hands_of_person(person);
  return std::any_of(hands.begin(), hands.end(),
                     [&](const Vector3& p_hand) { return (p_hand - p_world).norm() < distance; });
}

}  // namespace

void HeldObject::hold(const SceneObject& object) {
  if (attachment_.object != object.id) vain_offers_.clear();
  attachment_.object = object.id;
  attachment_.hand = arm_.hand_name();
  attachment_.T_tool_object = arm_.T_world_tool().inverse() * object.T_world_object;
}

bool HeldObject::is_in_hand(const SceneObject& object) const {
  const auto& hands = arm_.manipulators();
  const int hand = hand_index(hands, attachment_.hand);
  if (hand < 0 || attachment_.object != object.id) return false;
  const int palm = hands[static_cast<std::size_t>(hand)].palm;
  const Pose T_world_palm = now_.T_world_base() * arm_.robot().link_pose(now_.set_point(), palm);
  const Vector3 p_held = T_world_palm * attachment_.T_tool_object.translation();
  return (object.T_world_object.translation() - p_held).norm() < settings_.max_slip;
}

bool HeldObject::is_held_by_hand(const std::string& object) const {
  const SceneObject* held = now_.object(object);
  return held != nullptr && held->holder == Holder::robot &&
         hand_index(arm_.manipulators(), held->holder_id) == static_cast<int>(arm_.index());
}

bool HeldObject::is_at_hand_of(const std::string& person, const std::string& object) const {
  const SceneObject* thing = now_.object(object);
  const Person* found = now_.person(person);
  if (thing == nullptr || found == nullptr) return false;
  const ObjectModel* model = now_.model_of(object);
  if (model == nullptr)
    return has_hand_near(*found, thing->T_world_object.translation(), settings_.person_hand_range);
  const HandPoints hands = hands_of_person(*found);
  const Pose T_object_world = thing->T_world_object.inverse();
  return std::any_of(hands.begin(), hands.end(), [&](const Vector3& p_hand) {
    return surface_distance(*model, T_object_world * p_hand) < settings_.taken_range;
  });
}

bool HeldObject::is_taken_by(const std::string& person) const {
  const SceneObject* held =
      person.empty() || !is_holding() ? nullptr : now_.object(attachment_.object);
  return held != nullptr && held->holder != Holder::surface && is_at_hand_of(person, held->id);
}

bool HeldObject::is_out_of_hand() const {
  const SceneObject* held = !is_holding() ? nullptr : now_.object(attachment_.object);
  if (held == nullptr || held->holder == Holder::robot || held->holder == Holder::human)
    return false;
  if (now_.set_point().size() != arm_.robot().dof() || is_in_hand(*held)) return false;
  const Vector3& p = held->T_world_object.translation();
  const auto& people = now_.people().people;
  return std::none_of(people.begin(), people.end(), [&](const Person& person) {
    return has_hand_near(person, p, 2 * settings_.person_hand_range);
  });
}

void HeldObject::update(TimePoint now) {
  if (!is_out_of_hand()) seen_in_hand_ = now;
}

bool HeldObject::has_slipped(TimePoint now) const {
  return to_seconds(now - seen_in_hand_) > settings_.slip_time;
}

}  // namespace handsel::manipulation_planner
