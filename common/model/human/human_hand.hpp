// SPDX-License-Identifier: Apache-2.0
// Shape of a person's hand: a palm and five digits that close. Own method: capsules with the mean
// lengths of grown people's hands (Greiner 1991), scaled by the stature; one closure a digit, since
// the joints of a finger flex together.
#pragma once

#include <array>

#include "common/geometry/pose.hpp"
#include "common/messages/side.hpp"

namespace handsel {

/// A capsule.
struct HandPart {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of the axis [m]
  double radius{};                                 ///< [m]
};

/// Returns a part in another frame.
inline HandPart transformed(const Pose& T, const HandPart& part) {
  return {T * part.a, T * part.b, part.radius};
}

inline constexpr double kPalmDistance = 0.03;  ///< hand frame's origin to a held object [m]
inline constexpr int kDigits = 5;              ///< thumb, index, middle, ring and little finger
inline constexpr int kDigitSegments = 3;       ///< segments of each digit
inline constexpr int kPalmParts = 3;           ///< parts of the palm
inline constexpr int kHandParts = kPalmParts + kDigits * kDigitSegments;  ///< parts of a hand

/// Closure of each digit, thumb first: 0 straight, 1 fully flexed.
using Closures = std::array<double, kDigits>;

/// Parts in the hand frame: origin in the middle of the palm, x out of the palm, z along the
/// straight fingers; the thumb of a right hand is at +y.
class HumanHand {
 public:
  /// `stature`: of the person [m], > 0. `wrist`: distance from the wrist to the origin [m].
  HumanHand(Side side, double stature, double wrist);

  /// Returns the parts of the palm.
  const std::array<HandPart, kPalmParts>& palm() const { return palm_; }
  /// Returns the segments of a digit, the segment at the palm first. `digit`: 0 the thumb to 4 the
  /// little finger; `closure`: [0, 1].
  std::array<HandPart, kDigitSegments> digit(int digit, double closure) const;
  /// Returns the parts of the palm, then those of each digit.
  std::array<HandPart, kHandParts> parts(const Closures& closures) const;

 private:
  double scale_, mirror_;
  std::array<Vector3, kDigits> base_;  // where each digit begins
  std::array<HandPart, kPalmParts> palm_;
};

}  // namespace handsel
