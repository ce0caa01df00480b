// SPDX-License-Identifier: Apache-2.0
// How the digits of a person's hand close on an object. Own method: the closure of a digit grows
// in equal steps until a segment touches the object; the step of the contact is halved.
#pragma once

#include <array>
#include <optional>

#include "common/model/human/human_hand.hpp"
#include "common/model/object_model.hpp"

namespace handsel {

/// Returns the distance of a part of a hand from an object [m], negative: they overlap; both in the
/// object frame. `nearest`: point of the part's axis, may be null.
double surface_distance(const ObjectModel& object, const HandPart& part,
                        Vector3* nearest = nullptr);

/// Contact of a digit.
struct DigitContact {
  double closure{};                   ///< of the digit, as in Closures
  double distance{};                  ///< of the digit from the object [m], <= 0
  Vector3 p_object{Vector3::Zero()};  ///< nearest point of the digit's axis [m]
};

inline constexpr int kClosureSteps = 20;  ///< steps of a digit from straight to fully flexed

/// Returns the first contact of a closing digit; nullopt: the digit does not meet the object.
std::optional<DigitContact> first_contact(const HumanHand& hand, int digit,
                                          const ObjectModel& object, const Pose& T_object_hand);

/// Returns the closure of a finger that does not meet the object: that of the nearest finger that
/// does, of equally near ones the smaller, since neighbouring fingers flex together; 0 of a thumb
/// or without contacts. `contacts`: of all digits.
double free_closure(int digit, const std::array<std::optional<double>, kDigits>& contacts);

}  // namespace handsel
