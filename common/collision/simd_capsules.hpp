// SPDX-License-Identifier: Apache-2.0
// Capsules side by side for the SIMD distance kernel.
#pragma once

#include "common/collision/simd_kernel.hpp"
#include "common/geometry/pose.hpp"

namespace handsel {

/// Returns the capsule with axis a to b and this radius [m], with what the kernel needs of it
/// worked out.
inline detail::SimdCapsule simd_capsule(const Vector3& a, const Vector3& b, double radius) {
  const Vector3 d = b - a, middle = 0.5 * (a + b);
  const auto f = [](double x) { return static_cast<float>(x); };
  const double dd = d.squaredNorm();
  return {f(a.x()),      f(a.y()),
          f(a.z()),      f(d.x()),
          f(d.y()),      f(d.z()),
          f(dd),         f(dd > 1e-12 ? 1 / dd : 0.0),
          f(radius),     f(0.5 * d.norm() + radius),
          f(middle.x()), f(middle.y()),
          f(middle.z())};
}

/// Returns sixteen capsules that are a thousand kilometres away.
inline detail::SimdCapsules no_capsules() {
  detail::SimdCapsules out{};
  for (int i = 0; i < 16; ++i) out.mx[i] = out.ax[i] = 1e6f;
  return out;
}

/// Writes a capsule to one of the sixteen places, 0 to 15.
inline void put_capsule(const detail::SimdCapsule& c, int slot, detail::SimdCapsules& out) {
  out.ax[slot] = c.ax, out.ay[slot] = c.ay, out.az[slot] = c.az;
  out.dx[slot] = c.dx, out.dy[slot] = c.dy, out.dz[slot] = c.dz;
  out.dd[slot] = c.dd, out.over_dd[slot] = c.over_dd;
  out.radius[slot] = c.radius, out.reach[slot] = c.reach;
  out.mx[slot] = c.mx, out.my[slot] = c.my, out.mz[slot] = c.mz;
}

}  // namespace handsel
