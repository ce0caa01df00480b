// SPDX-License-Identifier: Apache-2.0
#include "common/model/human/palm.hpp"

#include <algorithm>

namespace handsel {

bool is_knuckle(const std::string& name) {
  return std::any_of(kKnuckles.begin(), kKnuckles.end(),
                     [&](const Knuckles& k) { return name == k.index || name == k.pinky; });
}

Vector3 across_palm(Side side, const Vector3& fingers, const Vector3& normal) {
  const Vector3 across = fingers.cross(normal);
  return side == Side::right ? across : Vector3(-across);
}

std::optional<Vector3> palm_normal(Side side, const Vector3& fingers, const Vector3& across) {
  constexpr double kMinSine = 0.3;  // min sine of the angle between the two directions
  const Vector3 normal = across.stableNormalized().cross(fingers.stableNormalized());
  if (!(normal.norm() > kMinSine)) return std::nullopt;
  return side == Side::right ? Vector3(normal.normalized()) : Vector3(-normal.normalized());
}

std::optional<Vector3> palm_of(const Person& person, Side side) {
  const char* hand = kKnuckles[side == Side::left ? 0 : 1].hand;
  for (const PalmDirection& palm : person.palms)
    if (palm.joint == hand) return palm.normal;
  return std::nullopt;
}

}  // namespace handsel
