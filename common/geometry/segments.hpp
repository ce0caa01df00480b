// SPDX-License-Identifier: Apache-2.0
// Nearest approach of two straight segments.
#pragma once

#include <algorithm>

#include "common/geometry/pose.hpp"

namespace handsel {

/// Points of segments [a0, a1] and [b0, b1] nearest each other; segments may be points. Returns the
/// squared distance [m^2].
inline double nearest_points(const Vector3& a0, const Vector3& a1, const Vector3& b0,
                             const Vector3& b1, Vector3& on_a, Vector3& on_b) {
  const Vector3 u = a1 - a0, v = b1 - b0, w = a0 - b0;
  const double a = u.squaredNorm(), b = u.dot(v), c = v.squaredNorm(), d = u.dot(w), e = v.dot(w);
  constexpr double kTiny = 1e-18;
  const double determinant = a * c - b * b;
  double s = 0, t = 0;
  if (a > kTiny)
    s = determinant > 1e-12 * a * c ? std::clamp((b * e - c * d) / determinant, 0.0, 1.0) : 0.0;
  if (c > kTiny) {
    t = (b * s + e) / c;
    const double inside = std::clamp(t, 0.0, 1.0);
    if (t != inside || determinant <= 1e-12 * a * c) {
      t = inside;
      if (a > kTiny) s = std::clamp((b * t - d) / a, 0.0, 1.0);
    }
  } else if (a > kTiny) {
    s = std::clamp(-d / a, 0.0, 1.0);
  }
  on_a = a0 + s * u;
  on_b = b0 + t * v;
  return (on_a - on_b).squaredNorm();
}

}  // namespace handsel
