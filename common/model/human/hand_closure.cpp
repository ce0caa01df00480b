// SPDX-License-Identifier: Apache-2.0
#include "common/model/human/hand_closure.hpp"

#include <algorithm>
#include <limits>

#include "common/model/object_surface.hpp"

namespace handsel {

double surface_distance(const ObjectModel& object, const HandPart& part, Vector3* nearest) {
  constexpr int kSamples = 4;  // intervals between the points tested along the axis
  double min_distance = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSamples; ++i) {
    const Vector3 p = part.a + i * (part.b - part.a) / kSamples;
    const double d = surface_distance(object, p) - part.radius;
    if (d >= min_distance) continue;
    min_distance = d;
    if (nearest != nullptr) *nearest = p;
  }
  return min_distance;
}

namespace {

/// Returns the part of a digit that is nearest to the object.
DigitContact nearest_part(const HumanHand& hand, int digit, double closure,
                          const ObjectModel& object, const Pose& T_object_hand) {
  DigitContact out{closure, std::numeric_limits<double>::infinity(), Vector3::Zero()};
  for (const HandPart& part : hand.digit(digit, closure)) {
    Vector3 nearest;
    const double d = surface_distance(object, transformed(T_object_hand, part), &nearest);
    if (d < out.distance) out.distance = d, out.p_object = nearest;
  }
  return out;
}

}  // namespace

std::optional<DigitContact> first_contact(const HumanHand& hand, int digit,
                                          const ObjectModel& object, const Pose& T_object_hand) {
  constexpr int kHalvings = 5;  // of the step in which the contact begins
  for (int i = 0; i <= kClosureSteps; ++i) {
    DigitContact contact =
        nearest_part(hand, digit, static_cast<double>(i) / kClosureSteps, object, T_object_hand);
    if (contact.distance > 0) continue;
    double free = (i - 1.0) / kClosureSteps;
    for (int k = 0; k < kHalvings && i > 0; ++k) {
      const double middle = (free + contact.closure) / 2;
      const DigitContact there = nearest_part(hand, digit, middle, object, T_object_hand);
      if (there.distance <= 0)
        contact = there;
      else
        free = middle;
    }
    return contact;
  }
  return std::nullopt;
}

double free_closure(int digit, const std::array<std::optional<double>, kDigits>& contacts) {
  if (digit == 0) return 0;
  for (int away = 1; away < kDigits; ++away) {
    std::optional<double> closure;
    for (const int other : {digit - away, digit + away}) {
      if (other < 1 || other >= kDigits || !contacts[other]) continue;
      closure = std::min(closure.value_or(1.0), *contacts[other]);
    }
    if (closure) return *closure;
  }
  return 0;
}

}  // namespace handsel
