// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/mesh_polygon.hpp"

#include <cmath>

namespace handsel::mesh {
namespace {

using Flat = Eigen::Vector2d;

/// Returns the corner of a quadrilateral with an inner angle above 180 degrees; 0 if there is none.
std::size_t reflex_corner(const std::vector<Vector3>& points, const std::vector<int>& corners) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3& at = points[static_cast<std::size_t>(corners[i])];
    const auto direction = [&](std::size_t k) -> Vector3 {
      return (points[static_cast<std::size_t>(corners[(i + k) % 4])] - at).normalized();
    };
    const Vector3 across = direction(2);
    const auto angle = [&](std::size_t k) {
      return std::acos(std::clamp(direction(k).dot(across), -1.0, 1.0));
    };
    if (angle(1) + angle(3) > M_PI) return i;
  }
  return 0;
}

double turn(const Flat& a, const Flat& b, const Flat& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Returns the corners in the polygon's mean plane, counter-clockwise.
std::vector<Flat> flattened(const std::vector<Vector3>& points, const std::vector<int>& corners) {
  Vector3 normal = Vector3::Zero();
  const auto at = [&](std::size_t i) -> const Vector3& {
    return points[static_cast<std::size_t>(corners[i % corners.size()])];
  };
  for (std::size_t i = 0; i < corners.size(); ++i)
    normal += (at(i) - at(0)).cross(at(i + 1) - at(0));
  const Vector3 axis = normal.stableNormalized();
  const Vector3
      x = (std::abs(axis.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY()).cross(axis).normalized(),
      y = axis.cross(x);
  std::vector<Flat> flat;
  for (std::size_t i = 0; i < corners.size(); ++i)
    flat.emplace_back((at(i) - at(0)).dot(x), (at(i) - at(0)).dot(y));
  return flat;
}

/// Returns whether the remaining corner `i` can be cut off: it is convex and its triangle contains
/// no other corner.
bool is_ear(const std::vector<Flat>& flat, const std::vector<std::size_t>& left, std::size_t i) {
  const std::size_t n = left.size(), before = left[(i + n - 1) % n], after = left[(i + 1) % n];
  const Flat &a = flat[before], &b = flat[left[i]], &c = flat[after];
  if (!(turn(a, b, c) > 0)) return false;
  for (const std::size_t other : left) {
    if (other == before || other == left[i] || other == after) continue;
    const Flat& p = flat[other];
    if (turn(a, b, p) > 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0) return false;
  }
  return true;
}

}  // namespace

void split_polygon(const std::vector<Vector3>& points, const std::vector<int>& corners,
                   std::vector<std::array<int, 3>>& triangles) {
  const std::size_t n = corners.size();
  if (n <= 4) {
    const std::size_t first = n == 4 ? reflex_corner(points, corners) : 0;
    for (std::size_t i = 1; i + 1 < n; ++i)
      triangles.push_back({corners[first], corners[(first + i) % n], corners[(first + i + 1) % n]});
    return;
  }
  const std::vector<Flat> flat = flattened(points, corners);
  std::vector<std::size_t> left(n);
  for (std::size_t i = 0; i < n; ++i) left[i] = i;
  while (left.size() > 2) {
    std::size_t ear = 0;
    while (ear < left.size() && !is_ear(flat, left, ear)) ++ear;
    if (ear == left.size()) ear = 0;  // the polygon intersects itself or has no area
    const std::size_t m = left.size();
    triangles.push_back(
        {corners[left[(ear + m - 1) % m]], corners[left[ear]], corners[left[(ear + 1) % m]]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
}

}  // namespace handsel::mesh
