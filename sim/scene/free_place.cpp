// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/free_place.hpp"

#include <algorithm>

namespace handsel::sim {

namespace {

constexpr int kMaxDraws = 2000;  // max number of drawn places

bool is_free(const Surface& surface, const Vector2& p, double distance) {
  return std::none_of(
             surface.circles.begin(), surface.circles.end(),
             [&](const TakenCircle& c) { return (p - c.centre).norm() < distance + c.radius; }) &&
         std::none_of(surface.rectangles.begin(), surface.rectangles.end(),
                      [&](const TakenRectangle& r) {
                        return (p - p.cwiseMax(r.low).cwiseMin(r.high)).norm() < distance;
                      });
}

}  // namespace

std::optional<Vector2> free_place(const Surface& surface, double radius, double clearance,
                                  const std::function<double()>& uniform) {
  const double distance = radius + clearance;
  const Vector2 half = surface.size / 2 - Vector2::Constant(distance);
  if (half.minCoeff() < 0) return std::nullopt;
  for (int i = 0; i < kMaxDraws; ++i) {
    const double x = 2 * uniform() - 1, y = 2 * uniform() - 1;
    const Vector2 p(x * half.x(), y * half.y());
    if (is_free(surface, p, distance)) return p;
  }
  return std::nullopt;
}

}  // namespace handsel::sim
