// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/actions/object_sight.hpp"

#include <cstdio>

namespace handsel::manipulation_planner {
namespace {

bool is_seen(const Parts& parts, const SceneObject& object) {
  return object.age <= parts.settings.max_object_age;
}

/// Returns whether the object can be picked up where it is now.
bool is_available(const Parts& parts, const std::string& id) {
  const SceneObject* object = parts.now.object(id);
  return object != nullptr && object->holder != Holder::human && is_seen(parts, *object) &&
         object->velocity.norm() <= parts.settings.offer_still;
}

/// Returns why the object is not available, one sentence.
Outcome why_unavailable(const Parts& parts, const std::string& id) {
  const SceneObject* object = parts.now.object(id);
  if (object == nullptr) return Outcome::failure("object " + id + " is not in the scene");
  if (object->holder == Holder::human && is_seen(parts, *object))
    return Outcome::failure(object->holder_id + " has " + id);
  if (is_seen(parts, *object)) return Outcome::failure(id + " is moved about");
  const Vector3 p = object->T_world_object.translation();
  char text[160];
  std::snprintf(text, sizeof text,
                " was last seen %.0f s ago at (%.2f, %.2f, %.2f), and was not found there, on a "
                "surface or in a hand",
                object->age, p.x(), p.y(), p.z());
  return Outcome::failure(id + text, ActionFailure::not_visible);
}

}  // namespace

Routine<Outcome> await_object(Parts& parts, const std::string& object, TimePoint deadline) {
  const auto available = [&parts, &object] { return is_available(parts, object); };
  if (available()) co_return Outcome{};
  parts.action.phase = ActionPhase::looking_for_object;
  const double left = std::max(0.0, to_seconds(deadline - parts.now.time()));
  const bool found = co_await parts.waiting.until(available, left);
  if (!found) co_return why_unavailable(parts, object);
  co_return Outcome{};
}

ObjectTarget object_at_rest(const Parts& parts, const std::string& object) {
  ObjectTarget target;
  target.object = object;
  target.max_shift = parts.settings.max_object_shift;
  if (const SceneObject* seen = parts.now.object(object))
    target.p_world = seen->T_world_object.translation();
  return target;
}

}  // namespace handsel::manipulation_planner
