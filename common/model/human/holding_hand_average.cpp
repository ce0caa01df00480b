// SPDX-License-Identifier: Apache-2.0
#include "common/model/human/holding_hand_average.hpp"

#include <algorithm>
#include <utility>

namespace handsel {

namespace {

// A hand that is this far from its average holds the object at another place [m].
constexpr double kOtherPlace = 0.06;
// Same for its average over so many samples.
constexpr double kOtherPlaceOfMean = 0.02;
constexpr int kRecentSamples = 5;
constexpr int kSamplesAfterChange = 2;  // weight of such a mean, mixed with the place before

/// Moves an average toward a sample, which counts 1 / samples.
void add_to(HoldingHand& average, const HoldingHand& seen, int samples) {
  average.p_wrist += (seen.p_wrist - average.p_wrist) / samples;
  average.p_hand += (seen.p_hand - average.p_hand) / samples;
}

/// Moves the average of a palm, which may be unobserved for some samples, toward a sample.
void add_palm(HoldingHand& average, const HoldingHand& seen, int samples) {
  if (!seen.palm) return;
  if (!average.palm) average.palm = seen.palm;
  *average.palm += (*seen.palm - *average.palm) / samples;
}

}  // namespace

void HoldingHandAverage::Hold::add(const HoldingHand& seen, int max_samples) {
  samples = std::min(samples + 1, max_samples);
  if (seen.palm) palm_samples = std::min(palm_samples + 1, max_samples);
  add_palm(hand, seen, palm_samples);
  add_palm(recent, seen, std::min(palm_samples, kRecentSamples));
  add_to(hand, seen, samples);
  add_to(recent, seen, std::min(samples, kRecentSamples));
  if ((recent.p_hand - hand.p_hand).norm() < kOtherPlaceOfMean) return;
  hand = recent;
  samples = std::min(samples, kSamplesAfterChange);
  palm_samples = std::min(palm_samples, kSamplesAfterChange);
}

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
    Hold hold{person->id, *seen, *seen, 0, 0};
    const auto before = holds_.find(object.id);
    if (before != holds_.end() && before->second.person == person->id &&
        before->second.hand.side == seen->side &&
        (before->second.hand.p_hand - seen->p_hand).norm() < kOtherPlace)
      hold = before->second;
    hold.add(*seen, max_samples_);
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
