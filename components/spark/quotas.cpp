// SPDX-License-Identifier: Apache-2.0
#include "components/spark/quotas.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "common/config/settings_text.hpp"

namespace handsel::spark {
namespace {

Vector3 axis(const Coverage& reach, double z) {
  return {(reach.low.x() + reach.high.x()) / 2, (reach.low.y() + reach.high.y()) / 2,
          std::clamp(z, reach.low.z(), reach.high.z())};
}

/// Returns the class of a fact by its kind: 0 safety and handover, 1 facts for task planning, 2
/// activities of people, 3 all others.
int order_of(FactKind kind) {
  switch (kind) {
    case FactKind::in_contact_zone:
    case FactKind::in_danger_zone:
    case FactKind::in_interaction_zone:
    case FactKind::in_social_zone:
    case FactKind::approaching:
    case FactKind::held_by_robot:
    case FactKind::held_by_human:
    case FactKind::released:
    case FactKind::offering:
    case FactKind::waiting_to_receive:
    case FactKind::withdrawn:
    case FactKind::reaching:
      return 0;
    case FactKind::attentive:
    case FactKind::on_surface:
    case FactKind::reachable_by_robot:
    case FactKind::inside:
      return 1;
    case FactKind::hand_near_object:
    case FactKind::reachable_by_human:
    case FactKind::looking_at:
    case FactKind::moving:
      return 2;
    case FactKind::visible_to:
    case FactKind::next_to:
      return 3;
  }
  return 3;
}

}  // namespace

Quotas quotas_of(const settings::SparkSettings& settings) {
  return {settings.max_bodies,  settings.max_tracks,        settings.max_people,
          settings.max_sources, settings.max_known_objects, settings.max_objects,
          settings.max_boxes,   settings.max_facts};
}

void check_quotas(const settings::SparkSettings& settings, const SettingsText& text) {
  const auto is = [](std::uint32_t value) { return "is " + std::to_string(value) + ", must be "; };
  if (!(settings.max_people < settings.max_bodies && settings.max_bodies <= settings.max_tracks))
    text.refuse("max_bodies", is(settings.max_bodies) + "above max_people and at most max_tracks");
  if (settings.max_objects > settings.max_known_objects)
    text.refuse("max_objects", is(settings.max_objects) + "at most max_known_objects");
}

double arm_radius(const Coverage& reach) { return (reach.high.x() - reach.low.x()) / 2; }

double distance_to_arm(const Vector3& point, const Coverage& reach) {
  return (point - axis(reach, point.z())).norm();
}

double distance_to_arm(const Person& person, const Coverage& reach) {
  double min_distance = std::numeric_limits<double>::infinity();
  for (const BodyJoint& joint : person.joints)
    min_distance = std::min(min_distance, distance_to_arm(joint.position, reach));
  return min_distance - person.inflation;
}

double distance_to_arm(const ObservedPerson& person, const Coverage& reach) {
  double min_distance = std::numeric_limits<double>::infinity();
  for (const ObservedJoint& joint : person.joints)
    min_distance = std::min(min_distance, distance_to_arm(joint.position, reach));
  return person.joints.empty() && person.has_gaze ? distance_to_arm(person.gaze_origin, reach)
                                                  : min_distance;
}

double distance_to_arm(const SceneBox& box, const Coverage& reach) {
  constexpr int kSamples = 5;  // points of the axis
  const Eigen::AlignedBox3d extent(-box.size / 2, box.size / 2);
  const Pose T_box_world = box.T_world_box.inverse();
  double min_distance = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kSamples; ++i) {
    const double z = reach.low.z() + (reach.high.z() - reach.low.z()) * i / (kSamples - 1);
    min_distance =
        std::min(min_distance, extent.exteriorDistance(Vector3(T_box_world * axis(reach, z))));
  }
  return min_distance;
}

Rank rank_of(const SceneObject& object, bool requested, const Coverage& reach) {
  const int order = object.holder == Holder::robot   ? 0
                    : object.holder == Holder::human ? 1
                    : requested                      ? 2
                                                     : 3;
  return {order, distance_to_arm(object.T_world_object.translation(), reach)};
}

std::vector<bool> nearest_of(const std::vector<ObservedPerson>& bodies, std::size_t max,
                             const Coverage* reach) {
  std::vector<bool> out(bodies.size(), reach == nullptr || bodies.size() <= max);
  if (reach == nullptr || bodies.size() <= max) return out;
  std::vector<std::size_t> order(bodies.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  keep_lowest(order, max, [&](std::size_t body) {
    return Rank{0, distance_to_arm(bodies[body], *reach)};
  });
  for (const std::size_t body : order) out[body] = true;
  return out;
}

LeftOut keep_most_relevant(std::vector<Fact>& facts, std::size_t max, const Scene& scene,
                           const HumanState& people, const Coverage& reach) {
  if (facts.size() <= max) return {};
  std::map<std::string, Rank> named;
  for (const SceneObject& object : scene.objects) named[object.id] = rank_of(object, false, reach);
  for (const Person& person : people.people) named[person.id] = {3, distance_to_arm(person, reach)};
  const auto rank = [&](const Fact& fact) {
    Rank out{order_of(fact.kind), std::numeric_limits<double>::infinity()};
    for (const std::string* name : {&fact.subject, &fact.object}) {
      const auto found = named.find(*name);
      if (found == named.end()) continue;
      out.distance = std::min(out.distance, found->second.distance);
      if (found->second.order < 2)
        out.order = std::min(out.order, 1);  // the fact is about a held object
    }
    return out;
  };
  return keep_lowest(facts, max, rank);
}

}  // namespace handsel::spark
