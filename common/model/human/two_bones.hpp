// SPDX-License-Identifier: Apache-2.0
// A limb of two bones between two known ends.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/geometry/pose.hpp"

namespace handsel {

/// The middle joint of a limb from `a` to `b` with bones `first` and `second` long, on the side of
/// the line where `hint` is; below it when the hint says nothing. When the ends are too far apart:
/// on the line, in proportion.
inline Vector3 bend(const Vector3& a, const Vector3& b, double first, double second,
                    const Vector3& hint) {
  const Vector3 line = b - a;
  const double d = line.norm();
  if (d < 1e-6) return hint;
  const Vector3 along = line / d;
  const double total = first + second;
  if (d >= total) return a + (first / total) * line;
  const double x = (d * d + first * first - second * second) / (2 * d);
  Vector3 aside = hint - a - along * along.dot(hint - a);
  if (aside.norm() < 1e-6) aside = -Vector3::UnitZ() + along * along.z();
  if (aside.norm() < 1e-6) aside = Vector3::UnitX();
  return a + x * along + std::sqrt(std::max(first * first - x * x, 0.0)) * aside.normalized();
}

}  // namespace handsel
