#include "components/spark/quotas.hpp"

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"

namespace handsel::spark {
namespace {

/// A setting with its range. The upper ends of people, objects, boxes, facts and sources are the
/// bounds of the lists on the wire.
struct Setting {
  const char* key;
  bool given;
  std::uint32_t value;
  std::size_t Quotas::*quota;
  std::uint32_t low, high;
};

std::array<Setting, 8> settings_of(const config::SparkSettings& s) {
  return {{{"max_bodies", s.has_max_bodies(), s.max_bodies(), &Quotas::bodies, 2, 256},
           {"max_tracks", s.has_max_tracks(), s.max_tracks(), &Quotas::tracks, 2, 1024},
           {"max_people", s.has_max_people(), s.max_people(), &Quotas::people, 1, 16},
           {"max_sources", s.has_max_sources(), s.max_sources(), &Quotas::sources, 1, 16},
           {"max_known_objects", s.has_max_known_objects(), s.max_known_objects(),
            &Quotas::known_objects, 1, 1024},
           {"max_objects", s.has_max_objects(), s.max_objects(), &Quotas::objects, 1, 64},
           {"max_boxes", s.has_max_boxes(), s.max_boxes(), &Quotas::boxes, 1, 64},
           {"max_facts", s.has_max_facts(), s.max_facts(), &Quotas::facts, 1, 256}}};
}

Vector3 axis(const Coverage& reach, double z) {
  return {(reach.low.x() + reach.high.x()) / 2, (reach.low.y() + reach.high.y()) / 2,
          std::clamp(z, reach.low.z(), reach.high.z())};
}

/// Order of a fact by its kind: 0 safety and exchange, 1 what a task plans with, 2 what people do,
/// 3 the rest.
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

Quotas quotas_of(const config::SparkSettings& settings) {
  Quotas out;
  for (const Setting& one : settings_of(settings))
    if (one.given) out.*one.quota = one.value;
  return out;
}

void check_quotas(const config::SparkSettings& settings, const std::filesystem::path& file) {
  for (const Setting& one : settings_of(settings))
    if (one.given && (one.value < one.low || one.value > one.high))
      throw ConfigError(locate(file, one.key) + ": " + one.key + " is " +
                        std::to_string(one.value) + "; it must be from " + std::to_string(one.low) +
                        " to " + std::to_string(one.high));
  const Quotas quotas = quotas_of(settings);
  if (!(quotas.people < quotas.bodies && quotas.bodies <= quotas.tracks))
    throw ConfigError(locate(file, "max_bodies") + ": max_bodies is " +
                      std::to_string(quotas.bodies) +
                      "; it must be above max_people and at most max_tracks");
  if (quotas.objects > quotas.known_objects)
    throw ConfigError(locate(file, "max_objects") + ": max_objects is " +
                      std::to_string(quotas.objects) + "; it must be at most max_known_objects");
}

double arm_radius(const Coverage& reach) { return (reach.high.x() - reach.low.x()) / 2; }

double distance_to_arm(const Vector3& point, const Coverage& reach) {
  return (point - axis(reach, point.z())).norm();
}

double distance_to_arm(const Person& person, const Coverage& reach) {
  double least = std::numeric_limits<double>::infinity();
  for (const BodyJoint& joint : person.joints)
    least = std::min(least, distance_to_arm(joint.position, reach));
  return least - person.inflation;
}

double distance_to_arm(const ObservedPerson& person, const Coverage& reach) {
  double least = std::numeric_limits<double>::infinity();
  for (const ObservedJoint& joint : person.joints)
    least = std::min(least, distance_to_arm(joint.position, reach));
  return person.joints.empty() && person.has_gaze ? distance_to_arm(person.gaze_origin, reach)
                                                  : least;
}

double distance_to_arm(const SceneBox& box, const Coverage& reach) {
  constexpr int kSamples = 5;  // points of the axis
  const Eigen::AlignedBox3d extent(-box.size / 2, box.size / 2);
  const Pose T_box_world = box.T_world_box.inverse();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kSamples; ++i) {
    const double z = reach.low.z() + (reach.high.z() - reach.low.z()) * i / (kSamples - 1);
    least = std::min(least, extent.exteriorDistance(Vector3(T_box_world * axis(reach, z))));
  }
  return least;
}

Rank rank_of(const SceneObject& object, bool wanted, const Coverage& reach) {
  const int order = object.holder == Holder::robot   ? 0
                    : object.holder == Holder::human ? 1
                    : wanted                         ? 2
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
        out.order = std::min(out.order, 1);  // it is about something that is held
    }
    return out;
  };
  return keep_lowest(facts, max, rank);
}

}  // namespace handsel::spark
