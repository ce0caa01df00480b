#include "common/model/human/holding_hand_average.hpp"

#include <algorithm>
#include <utility>

namespace handsel {

namespace {

// A hand that is this far from its average holds the object at another place [m].
constexpr double kOtherPlace = 0.06;

}  // namespace

HoldingHandAverage::HoldingHandAverage(Models models, int samples)
    : models_(std::move(models)), max_samples_(std::max(1, samples)) {}

void HoldingHandAverage::add(const Scene& scene, const HumanState& people) {
  std::map<std::string, Hold> holds;
  for (const SceneObject& object : scene.objects) {
    if (object.holder != Holder::human) continue;
    const ObjectModel* model = models_ ? models_(object.model) : nullptr;
    const auto person = std::find_if(people.people.begin(), people.people.end(),
                                     [&](const Person& p) { return p.id == object.holder_id; });
    if (person == people.people.end() || model == nullptr) continue;
    const auto seen = holding_hand(*person, *model, object.T_world_object);
    if (!seen) continue;
    Hold hold{person->id, *seen, 0};
    const auto before = holds_.find(object.id);
    if (before != holds_.end() && before->second.person == person->id &&
        before->second.hand.side == seen->side &&
        (before->second.hand.p_hand - seen->p_hand).norm() < kOtherPlace)
      hold = before->second;
    hold.samples = std::min(hold.samples + 1, max_samples_);
    hold.hand.p_wrist += (seen->p_wrist - hold.hand.p_wrist) / hold.samples;
    hold.hand.p_hand += (seen->p_hand - hold.hand.p_hand) / hold.samples;
    holds.emplace(object.id, std::move(hold));
  }
  holds_ = std::move(holds);
}

HumanState HoldingHandAverage::averaged(const Scene& scene, HumanState people) const {
  for (const SceneObject& object : scene.objects) {
    const auto found = holds_.find(object.id);
    if (object.holder != Holder::human || found == holds_.end()) continue;
    for (Person& person : people.people) {
      if (person.id == object.holder_id && person.id == found->second.person)
        move_hand(person, found->second.hand, object.T_world_object);
    }
  }
  return people;
}

}  // namespace handsel
