// SPDX-License-Identifier: Apache-2.0
#include "common/model/human/human_hand.hpp"

#include <algorithm>
#include <cmath>

namespace handsel {

namespace {

constexpr double kReferenceStature = 1.75;  // stature to which the lengths below belong [m]
constexpr double kPalmLength = 0.100;  // from the wrist to the knuckle of the middle finger [m]
constexpr double kPalmRadius = 0.014;  // half of the palm's thickness [m]

/// Lengths and knuckle of a digit [m].
struct DigitSize {
  double across;                   // of the knuckle toward the thumb, from the middle
  double beyond;                   // of the knuckle along the fingers, from the middle finger's
  double lengths[kDigitSegments];  // the segment at the palm first
  double radius;                   // of all segments
};
constexpr DigitSize kSizes[kDigits] = {{0.026, -0.075, {0.046, 0.034, 0.026}, 0.0095},
                                       {0.030, -0.004, {0.044, 0.025, 0.020}, 0.0085},
                                       {0.010, 0.000, {0.049, 0.029, 0.021}, 0.0085},
                                       {-0.010, -0.004, {0.045, 0.027, 0.021}, 0.0080},
                                       {-0.029, -0.012, {0.036, 0.020, 0.018}, 0.0070}};

// Flexion of the three joints of a fully closed finger [rad].
constexpr double kFlexion[kDigitSegments] = {1.4, 1.7, 1.0};
// Directions of the thumb's segments, open and closed, in the hand frame of a right hand.
const Vector3 kThumbOpen[kDigitSegments] = {Vector3(0.75, 0.62, 0.23), Vector3(0.93, 0.35, 0.10),
                                            Vector3(0.95, 0.28, 0.14)};
const Vector3 kThumbClosed[kDigitSegments] = {Vector3(0.62, 0.20, 0.76), Vector3(0.30, -0.45, 0.84),
                                              Vector3(-0.25, -0.55, 0.80)};

}  // namespace

HumanHand::HumanHand(Side side, double stature, double wrist)
    : scale_(stature / kReferenceStature), mirror_(side == Side::right ? 1.0 : -1.0) {
  const double knuckles = scale_ * kPalmLength - wrist;
  for (int d = 0; d < kDigits; ++d)
    base_[d] = {0, mirror_ * scale_ * kSizes[d].across, knuckles + scale_ * kSizes[d].beyond};
  base_[0].x() = scale_ * 0.5 * kPalmRadius;
  const int borders[kPalmParts] = {1, 2, 4};
  for (int i = 0; i < kPalmParts; ++i) {
    const Vector3& knuckle = base_[borders[i]];
    palm_[i] = {{0, 0.6 * knuckle.y(), -0.8 * wrist}, knuckle, scale_ * kPalmRadius};
  }
}

std::array<HandPart, kDigitSegments> HumanHand::digit(int digit, double closure) const {
  const DigitSize& size = kSizes[digit];
  const double c = std::clamp(closure, 0.0, 1.0);
  std::array<HandPart, kDigitSegments> out;
  Vector3 at = base_[digit];
  double angle = 0;
  for (int s = 0; s < kDigitSegments; ++s) {
    Vector3 direction;
    if (digit == 0) {
      direction = ((1 - c) * kThumbOpen[s] + c * kThumbClosed[s]).normalized();
      direction.y() *= mirror_;
    } else {
      angle += c * kFlexion[s];
      direction = {std::sin(angle), 0, std::cos(angle)};
    }
    const Vector3 end = at + scale_ * size.lengths[s] * direction;
    out[s] = {at, end, scale_ * size.radius};
    at = end;
  }
  return out;
}

std::array<HandPart, kHandParts> HumanHand::parts(const Closures& closures) const {
  std::array<HandPart, kHandParts> out;
  auto next = std::copy(palm_.begin(), palm_.end(), out.begin());
  for (int d = 0; d < kDigits; ++d) {
    const auto segments = digit(d, closures[d]);
    next = std::copy(segments.begin(), segments.end(), next);
  }
  return out;
}

}  // namespace handsel
