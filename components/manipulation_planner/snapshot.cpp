// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/snapshot.hpp"

#include <algorithm>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {

const SceneObject* Snapshot::object(const std::string& id) const {
  const auto& all = scene_.objects;
  const auto it =
      std::find_if(all.begin(), all.end(), [&](const SceneObject& o) { return o.id == id; });
  return it == all.end() ? nullptr : &*it;
}

const SceneBox* Snapshot::surface(const std::string& id) const {
  const auto& all = scene_.boxes;
  const auto it = std::find_if(all.begin(), all.end(),
                               [&](const SceneBox& b) { return b.id == id && b.supports; });
  return it == all.end() ? nullptr : &*it;
}

const ObjectModel* Snapshot::model_of(const std::string& id) const {
  const SceneObject* seen = object(id);
  return seen != nullptr && objects_ ? objects_(seen->model) : nullptr;
}

const Person* Snapshot::person(const std::string& id) const {
  const Person* best = nullptr;
  double nearest = 0;
  const Vector3 p_robot = T_world_platform(*this).translation();
  for (const auto& candidate : people_.people) {
    if (!id.empty() && candidate.id != id) continue;
    const Vector3 torso =
        candidate.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
    const double distance = (torso - p_robot).norm();
    if (best == nullptr || distance < nearest) {
      best = &candidate;
      nearest = distance;
    }
  }
  return best;
}

bool is_lost(const Snapshot& now, const std::string& id) {
  const auto& all = now.people().people;
  return std::any_of(all.begin(), all.end(),
                     [&](const Person& p) { return p.id == id && p.inflation > 0; });
}

}  // namespace handsel::manipulation_planner
