// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/receiver_hands.hpp"

#include <algorithm>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

const Vector3& position_of(const Person& person, const char* joint) {
  return person.joints[static_cast<std::size_t>(body_joint_index(joint))].position;
}

const Vector3& hand_position(const Person& person, Side side) {
  return position_of(person, side == Side::left ? "l_hand" : "r_hand");
}

/// Returns the level distance of a hand from its shoulder toward the robot [m].
double extension(const Person& person, Side side, const Vector3& p_world_robot) {
  const Vector3& shoulder = position_of(person, side == Side::left ? "l_shoulder" : "r_shoulder");
  const Vector3 level(1, 1, 0);
  const Vector3 toward = (p_world_robot - shoulder).cwiseProduct(level).stableNormalized();
  return (hand_position(person, side) - shoulder).dot(toward);
}

bool is_busy(const Person& person, const Scene& scene, Side side, double range) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [&](const SceneObject& object) {
    if (object.holder != Holder::human || object.holder_id != person.id) return false;
    const auto distance = [&](Side of) {
      return (object.T_world_object.translation() - hand_position(person, of)).norm();
    };
    return distance(side) < range && distance(side) <= distance(other_side(side));
  });
}

}  // namespace

ReceiverHands hands_of(const Person& person, const Scene& scene, const Vector3& p_world_robot,
                       const settings::ManipulationPlannerSettings& settings,
                       const ReceiverHands* before) {
  ReceiverHands hands;
  if (person.joints.size() != kBodyJoints.size()) return hands;
  hands.left_free = !is_busy(person, scene, Side::left, settings.busy_range);
  hands.right_free = !is_busy(person, scene, Side::right, settings.busy_range);
  const double stature = person.stature > 0 ? person.stature : settings.assumed_stature;
  for (const Side side : {Side::right, Side::left}) {
    const double out = extension(person, side, p_world_robot) / stature,
                 other = extension(person, other_side(side), p_world_robot) / stature;
    if (hands.is_free(side) && out > settings.ready_extension && out > other + settings.ready_lead)
      hands.ready = side;
  }
  if (!hands.ready && before != nullptr && before->ready && hands.is_free(*before->ready))
    hands.ready = before->ready;
  return hands;
}

std::optional<double> hand_cost(const ReceiverHands& hands, Side side, const std::string& person,
                                const settings::ManipulationPlannerSettings& settings) {
  if (!hands.is_free(side)) return std::nullopt;
  if (hands.ready) return *hands.ready == side ? 0.0 : settings.other_hand;
  const auto profile =
      std::find_if(settings.people.begin(), settings.people.end(),
                   [&](const settings::PersonProfile& one) { return one.id == person; });
  const bool is_left_handed =
      profile != settings.people.end() && profile->handed == settings::Handedness::left;
  const Side usual = is_left_handed ? Side::left : Side::right;
  return side == usual ? 0.0 : settings.left_hand;
}

}  // namespace handsel::manipulation_planner
