// Capsules side by side for the SIMD distance kernel.
#pragma once

#include "common/collision/simd_kernel.hpp"
#include "common/geometry/pose.hpp"

namespace handsel {

/// Returns the capsule with axis a to b and this radius [m], with what the kernel needs of it
/// worked out.
inline detail::WideCapsule wide_capsule(const Vector3& a, const Vector3& b, double radius) {
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
inline detail::WideCapsules no_capsules() {
  detail::WideCapsules out{};
  for (int i = 0; i < 16; ++i) out.mx[i] = out.ax[i] = 1e6f;
  return out;
}

/// Writes a capsule to one of the sixteen places, 0 to 15.
inline void put_capsule(const detail::WideCapsule& c, int lane, detail::WideCapsules& out) {
  out.ax[lane] = c.ax, out.ay[lane] = c.ay, out.az[lane] = c.az;
  out.dx[lane] = c.dx, out.dy[lane] = c.dy, out.dz[lane] = c.dz;
  out.dd[lane] = c.dd, out.over_dd[lane] = c.over_dd;
  out.radius[lane] = c.radius, out.reach[lane] = c.reach;
  out.mx[lane] = c.mx, out.my[lane] = c.my, out.mz[lane] = c.mz;
}

}  // namespace handsel
