// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/solid/convex_hull.hpp"

#include <cmath>
#include <numbers>
#include <set>

#include <LinearMath/btConvexHullComputer.h>

namespace handsel {
namespace {

/// Returns directions of a Fibonacci lattice on the sphere, after the six axis directions.
std::vector<Vector3> directions(int count) {
  std::vector<Vector3> out;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) out.push_back(sign * Vector3::Unit(axis));
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < count - 6; ++i) {
    const double z = 1 - 2 * (i + 0.5) / (count - 6), r = std::sqrt(1 - z * z);
    out.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return out;
}

}  // namespace

TriangleMesh convex_hull(const std::vector<Vector3>& points) {
  TriangleMesh out;
  if (points.size() < 4) return out;
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : points) middle += p / static_cast<double>(points.size());
  btConvexHullComputer hull;
  hull.compute(points.front().data(), sizeof(Vector3), static_cast<int>(points.size()), 0, 0);
  for (int i = 0; i < hull.vertices.size(); ++i)
    out.vertices.emplace_back(hull.vertices[i].x(), hull.vertices[i].y(), hull.vertices[i].z());
  for (int i = 0; i < hull.faces.size(); ++i) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[i]];
    const int begin = first->getSourceVertex();
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != begin;
         edge = edge->getNextEdgeOfFace()) {
      std::array<int, 3> t{begin, edge->getSourceVertex(), edge->getTargetVertex()};
      const auto corner = [&](int k) {
        return out.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
      };
      const Vector3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
      if (normal.dot(corner(0) - middle) < 0) std::swap(t[1], t[2]);
      out.triangles.push_back(t);
    }
  }
  if (!(volume_of(out) > 0)) out.triangles.clear();
  return out;
}

double volume_of(const TriangleMesh& mesh) {
  double sum = 0;
  if (mesh.vertices.empty()) return sum;
  const Vector3 origin = mesh.vertices.front();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](int i) -> Vector3 {
      return mesh.vertices[static_cast<std::size_t>(i)] - origin;
    };
    sum += at(a).dot(at(b).cross(at(c))) / 6;
  }
  return sum;
}

TriangleMesh reduced_hull(const std::vector<Vector3>& points, int max_points) {
  TriangleMesh whole = convex_hull(points);
  if (static_cast<int>(whole.vertices.size()) <= max_points) return whole;
  std::set<std::size_t> chosen;
  for (const Vector3& direction : directions(max_points)) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < whole.vertices.size(); ++i)
      if (direction.dot(whole.vertices[i]) > direction.dot(whole.vertices[best])) best = i;
    chosen.insert(best);
  }
  std::vector<Vector3> few;
  few.reserve(chosen.size());
  for (const std::size_t i : chosen) few.push_back(whole.vertices[i]);
  TriangleMesh reduced = convex_hull(few);
  return reduced.triangles.empty() ? whole : reduced;
}

}  // namespace handsel
