// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/held_digits.hpp"

#include <algorithm>

#include "common/model/human/holding_hand.hpp"

namespace handsel::path_planner {

HeldDigits::HeldDigits(const ObjectLibrary& objects, int samples, double clearance)
    : objects_(objects),
      holding_([objects](const std::string& model) { return objects ? objects(model) : nullptr; },
               samples),
      clearance_(clearance) {}

void HeldDigits::add(const Scene& scene, const HumanState& people) { holding_.add(scene, people); }

std::vector<OtherRobot> HeldDigits::obstacles(const Scene& scene, const HumanState& people,
                                              const std::vector<std::string>& allowed) const {
  const auto is_allowed = [&](const std::string& id) {
    return std::find(allowed.begin(), allowed.end(), id) != allowed.end();
  };
  std::vector<OtherRobot> out;
  const HumanState averaged = holding_.averaged(scene, people);
  for (const SceneObject& object : scene.objects) {
    if (object.holder != Holder::human || is_allowed(object.id) || is_allowed(object.holder_id))
      continue;
    const ObjectModel* model = objects_ ? objects_(object.model) : nullptr;
    const auto person = std::find_if(averaged.people.begin(), averaged.people.end(),
                                     [&](const Person& p) { return p.id == object.holder_id; });
    if (model == nullptr || person == averaged.people.end()) continue;
    OtherRobot digits = digits_as_obstacles(*person, *model, object.T_world_object,
                                            person->inflation + clearance_, {0.0});
    if (!digits.parts.empty()) out.push_back(std::move(digits));
  }
  return out;
}

}  // namespace handsel::path_planner
