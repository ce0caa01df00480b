// SPDX-License-Identifier: Apache-2.0
// Distances of the robot to people and to the scene.
#include <algorithm>
#include <cstdint>
#include <limits>

#include "common/collision/world/world_impl.hpp"

namespace handsel {

/// Checks all pairs at once in single precision, then those that may be nearest in double.
double CollisionWorld::distance_to_people(const Vector& q, Vector3* on_robot, Vector3* on_person) {
  constexpr float kSlack = 2e-4f;
  Impl& w = *impl_;
  double min_distance = std::numeric_limits<double>::infinity();
  if (w.people.empty()) return min_distance;
  w.robot.forward(q, w.T_root_link);
  const Vector3 origin = w.T_world_base.translation();
  std::vector<std::pair<Vector3, Vector3>>& ends = w.capsule_ends;
  ends.clear();
  w.simd_capsules.clear();
  for (const LinkCapsule& capsule : w.capsules) {
    const Pose T_world_link = w.T_world_base * w.T_root_link[capsule.link];
    ends.emplace_back(T_world_link * capsule.a, T_world_link * capsule.b);
    w.simd_capsules.push_back(
        simd_capsule(ends.back().first - origin, ends.back().second - origin, capsule.radius));
  }
  w.capsule_distances.resize(16 * ends.size() + 16);
  float* distances =
      w.capsule_distances.data() +
      (64 - reinterpret_cast<std::uintptr_t>(w.capsule_distances.data()) % 64) % 64 / sizeof(float);
  for (std::size_t first = 0; first < w.people.size(); first += 16) {
    detail::SimdCapsules capsules = no_capsules();
    const std::size_t count = std::min<std::size_t>(16, w.people.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Impl::MovingBody& body = w.people[first + i];
      put_capsule(simd_capsule(body.a - origin, body.b - origin, body.radius), static_cast<int>(i),
                  capsules);
    }
    const float nearest = detail::simd_kernels().distances(
        w.simd_capsules.data(), static_cast<int>(ends.size()), capsules, kSlack, distances);
    for (std::size_t c = 0; c < ends.size(); ++c)
      for (std::size_t i = 0; i < count; ++i) {
        if (!(distances[16 * c + i] <= nearest + kSlack)) continue;
        const Impl::MovingBody& body = w.people[first + i];
        Vector3 a, b;
        const double axes = segment_distance(ends[c].first, ends[c].second, body.a, body.b, &a, &b),
                     d = axes - w.capsules[c].radius - body.radius;
        if (d >= min_distance) continue;
        min_distance = d;
        const Vector3 along = axes > 1e-9 ? Vector3((b - a) / axes) : Vector3::UnitX();
        if (on_robot) *on_robot = a + w.capsules[c].radius * along;
        if (on_person) *on_person = b - body.radius * along;
      }
  }
  return min_distance;
}

double CollisionWorld::distance_to_scene(const Vector& q, double cap, Vector3* on_robot,
                                         Vector3* on_scene) {
  Impl& w = *impl_;
  w.place(q);
  struct Candidate {
    double bound;
    std::size_t body;
    const SceneBody* thing;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < w.bodies.size(); ++i) {
    if (!w.bodies[i].moves) continue;
    for (const auto* things : {&w.scene, &w.obstacles})
      for (const SceneBody& thing : *things) {
        if (thing.allowed && w.bodies[i].hand >= 0) continue;
        const double bound =
            gap_bound(*w.bodies[i].shape, w.T_world_body[i], *thing.shape, thing.T_world_shape);
        if (bound < cap) candidates.push_back({bound, i, &thing});
      }
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.bound < b.bound; });
  double min_distance = cap;
  for (const Candidate& c : candidates) {
    if (c.bound >= min_distance) break;
    const bool lowered = c.body >= w.link_bodies && c.thing->lowered;
    Vector3 on_body, on_thing;
    const double distance = gap(*w.bodies[c.body].shape, w.T_world_body[c.body],
                                lowered ? *c.thing->lowered : *c.thing->shape,
                                lowered ? c.thing->T_world_lowered : c.thing->T_world_shape,
                                on_robot ? &on_body : nullptr, on_scene ? &on_thing : nullptr);
    if (distance >= min_distance) continue;
    min_distance = distance;
    if (on_robot != nullptr) *on_robot = on_body;
    if (on_scene != nullptr) *on_scene = on_thing;
  }
  return min_distance;
}

}  // namespace handsel
