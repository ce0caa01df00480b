// SPDX-License-Identifier: Apache-2.0
#include "components/attention/object_search.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/human/body_index.hpp"

namespace handsel::attention {

namespace {

constexpr double kHandWeight = 0.8;  // of a hand at the last place; that of the place itself is 1
constexpr double kSurfaceWeight = 0.5;  // of a part of a surface at the last place
constexpr double kMiss = 0.35;  // probability that an observation of the right place finds nothing

const SceneObject* find(const Scene& scene, const std::string& id) {
  const auto at = std::find_if(scene.objects.begin(), scene.objects.end(),
                               [&](const SceneObject& object) { return object.id == id; });
  return at == scene.objects.end() ? nullptr : &*at;
}

/// Returns the centres of the parts of a surface's top, world [m].
std::vector<Vector3> parts_of(const SceneBox& box, double size) {
  std::vector<Vector3> parts;
  const int across = std::max(1, static_cast<int>(std::ceil(box.size.x() / size))),
            along = std::max(1, static_cast<int>(std::ceil(box.size.y() / size)));
  for (int i = 0; i < across; ++i)
    for (int k = 0; k < along; ++k)
      parts.push_back(box.T_world_box * Vector3(((i + 0.5) / across - 0.5) * box.size.x(),
                                                ((k + 0.5) / along - 0.5) * box.size.y(),
                                                box.size.z() / 2));
  return parts;
}

}  // namespace

bool is_object_lost(const World& world, double lost_after) {
  const ActionStatus* action = world.action;
  if (action == nullptr || action->state != ActionState::running || action->object.empty() ||
      action->holding || world.scene == nullptr)
    return false;
  const SceneObject* object = find(*world.scene, action->object);
  return object == nullptr || (object->age > lost_after && object->holder != Holder::robot);
}

void ObjectSearch::note_seen(const World& world) {
  if (world.action == nullptr || world.scene == nullptr) return;
  if (world.action->object != object_) p_last_.reset();
  object_ = world.action->object;
  if (const SceneObject* object = find(*world.scene, object_))
    p_last_ = object->T_world_object.translation();
}

std::vector<ObjectSearch::Place> ObjectSearch::places(const World& world) const {
  std::vector<Place> places;
  const auto add = [&](const std::string& name, const Vector3& p_world, double weight) {
    const double distance = p_last_ ? (p_world - *p_last_).norm() : 0.0;
    places.push_back({name, p_world, weight * std::exp(-distance / motor_.search_range)});
  };
  if (p_last_) add("last place", *p_last_, 1.0);
  if (world.people != nullptr)
    for (const Person& person : world.people->people) {
      if (person.joints.size() != kBodyJoints.size() || person.age > motor_.lost_after) continue;
      add("left hand of " + person.id, person.joints[body::l_hand].position, kHandWeight);
      add("right hand of " + person.id, person.joints[body::r_hand].position, kHandWeight);
    }
  for (const SceneBox& box : world.scene->boxes) {
    if (!box.supports) continue;
    int part = 0;
    for (const Vector3& p_world : parts_of(box, motor_.search_part))
      add(box.id + " " + std::to_string(part++), p_world, kSurfaceWeight);
  }
  return places;
}

std::optional<Vector3> ObjectSearch::target(const World& world, const Vector3& p_eye,
                                            TimePoint now) {
  note_seen(world);
  if (!is_object_lost(world, motor_.lost_after)) {
    tries_.clear();
    present_.clear();
    return std::nullopt;
  }
  const std::vector<Place> all = places(world);
  const auto at = [&](const std::string& name) {
    return std::find_if(all.begin(), all.end(), [&](const Place& p) { return p.name == name; });
  };
  auto chosen = at(present_);
  if (chosen != all.end() && to_seconds(now - since_) < motor_.search_dwell) return chosen->p_world;
  if (chosen != all.end()) ++tries_[present_];
  double best = -1;
  const auto direction = [&](const Vector3& p) { return (p - p_eye).stableNormalized(); };
  const std::optional<Vector3> before =
      chosen != all.end() ? std::optional(direction(chosen->p_world)) : std::nullopt;
  for (auto place = all.begin(); place != all.end(); ++place) {
    const auto tried = tries_.find(place->name);
    const double turn =
        before ? std::acos(std::clamp(before->dot(direction(place->p_world)), -1.0, 1.0)) : 0.0;
    const double value =
        place->weight * std::pow(kMiss, tried == tries_.end() ? 0 : tried->second) / (1 + turn);
    if (value <= best) continue;
    best = value;
    chosen = place;
  }
  if (chosen == all.end()) return std::nullopt;
  present_ = chosen->name;
  since_ = now;
  return chosen->p_world;
}

}  // namespace handsel::attention
