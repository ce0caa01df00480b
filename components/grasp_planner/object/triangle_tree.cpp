// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/object/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/geometry/segments.hpp"

namespace handsel::grasp_planner {
namespace {

double segment_segment_squared(const Vector3& a0, const Vector3& a1, const Vector3& b0,
                               const Vector3& b1) {
  Vector3 on_a, on_b;
  return nearest_points(a0, a1, b0, b1, on_a, on_b);
}

/// Barycentric coordinates of the point of the triangle nearest to p.
Vector3 nearest_on_triangle(const Vector3& p, const Vector3& a, const Vector3& b,
                            const Vector3& c) {
  const Vector3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4, along = (d4 - d3) / (d4 - d3 + d5 - d6);
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {0, 1 - along, along};
  const double v = vb / (va + vb + vc), w = vc / (va + vb + vc);
  return {1 - v - w, v, w};
}

double point_triangle_squared(const Vector3& p, const Vector3& a, const Vector3& b,
                              const Vector3& c) {
  const Vector3 k = nearest_on_triangle(p, a, b, c);
  return (p - k[0] * a - k[1] * b - k[2] * c).squaredNorm();
}

// Returns whether the segment passes through the triangle.
bool crosses(const Vector3& p, const Vector3& q, const Vector3& a, const Vector3& b,
             const Vector3& c) {
  const Vector3 d = q - p, e1 = b - a, e2 = c - a, h = d.cross(e2);
  const double det = e1.dot(h);
  if (std::abs(det) < 1e-18) return false;
  const Vector3 s = p - a;
  const double u = s.dot(h) / det;
  if (u < 0 || u > 1) return false;
  const Vector3 k = s.cross(e1);
  const double v = d.dot(k) / det, t = e2.dot(k) / det;
  return v >= 0 && u + v <= 1 && t >= 0 && t <= 1;
}

double segment_triangle_squared(const Vector3& p, const Vector3& q, const Vector3& a,
                                const Vector3& b, const Vector3& c) {
  if (crosses(p, q, a, b, c)) return 0.0;
  double best = std::min(point_triangle_squared(p, a, b, c), point_triangle_squared(q, a, b, c));
  best = std::min(best, segment_segment_squared(p, q, a, b));
  best = std::min(best, segment_segment_squared(p, q, b, c));
  return std::min(best, segment_segment_squared(p, q, c, a));
}

// Returns a lower bound of the squared distance of a segment (centre, half vector, box) to a box,
// from the boxes and from the ball around the segment.
double box_bound(const Eigen::AlignedBox3d& box, const Eigen::AlignedBox3d& segment,
                 const Vector3& middle, double half) {
  const double by_boxes = box.squaredExteriorDistance(segment);
  const double by_ball = std::max(0.0, std::sqrt(box.squaredExteriorDistance(middle)) - half);
  return std::max(by_boxes, by_ball * by_ball);
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  triangles_.reserve(mesh.triangles.size());
  for (const auto& k : mesh.triangles) {
    triangles_.push_back({mesh.vertices[static_cast<std::size_t>(k[0])],
                          mesh.vertices[static_cast<std::size_t>(k[1])],
                          mesh.vertices[static_cast<std::size_t>(k[2])],
                          static_cast<std::uint32_t>(triangles_.size())});
  }
  if (triangles_.empty()) return;
  build(0, triangles_.size());
  box_ = nodes_.front().box;
}

std::uint32_t TriangleTree::build(std::size_t begin, std::size_t end) {
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box, centres;
  for (std::size_t i = begin; i < end; ++i) {
    const Triangle& t = triangles_[i];
    box.extend(t.a);
    box.extend(t.b);
    box.extend(t.c);
    centres.extend((t.a + t.b + t.c) / 3);
  }
  nodes_[id].box = box;
  if (end - begin <= 4) {
    nodes_[id].left = static_cast<std::uint32_t>(begin);
    nodes_[id].count = static_cast<std::uint32_t>(end - begin);
    return id;
  }
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::size_t middle = (begin + end) / 2;
  const auto at = [this](std::size_t i) {
    return triangles_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(begin), at(middle), at(end), [axis](const Triangle& l, const Triangle& r) {
    return l.a[axis] + l.b[axis] + l.c[axis] < r.a[axis] + r.b[axis] + r.c[axis];
  });
  const std::uint32_t left = build(begin, middle), right = build(middle, end);
  nodes_[id].left = left;
  nodes_[id].right = right;
  return id;
}

bool TriangleTree::nearer_than(const Vector3& a, const Vector3& b, double radius) const {
  return search(a, b, radius, true) < radius;
}

double TriangleTree::distance(const Vector3& a, const Vector3& b, double limit) const {
  return search(a, b, limit, false);
}

double TriangleTree::search(const Vector3& a, const Vector3& b, double limit,
                            bool first_hit) const {
  if (nodes_.empty()) return limit;
  Eigen::AlignedBox3d segment;
  segment.extend(a);
  segment.extend(b);
  const Vector3 middle = 0.5 * (a + b);
  const double half = 0.5 * (b - a).norm();
  double best = limit * limit;
  std::array<std::uint32_t, 64> stack{};  // the tree is balanced: its depth is below 32
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (box_bound(node.box, segment, middle, half) >= best) continue;
    if (node.count > 0) {
      for (std::uint32_t i = node.left; i < node.left + node.count; ++i) {
        best = std::min(best, segment_triangle_squared(a, b, triangles_[i].a, triangles_[i].b,
                                                       triangles_[i].c));
      }
      if (best <= 0 || (first_hit && best < limit * limit)) return std::sqrt(best);
    } else {
      const double l = box_bound(nodes_[node.left].box, segment, middle, half),
                   r = box_bound(nodes_[node.right].box, segment, middle, half);
      stack[depth++] = l < r ? node.right : node.left;
      stack[depth++] = l < r ? node.left : node.right;
    }
  }
  return std::sqrt(best);
}

SurfaceHit TriangleTree::nearest(const Vector3& p) const {
  SurfaceHit out;
  double best = std::numeric_limits<double>::infinity();
  std::array<std::uint32_t, 64> stack{};
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (node.box.squaredExteriorDistance(p) >= best) continue;
    if (node.count == 0) {
      const bool left_first = nodes_[node.left].box.squaredExteriorDistance(p) <
                              nodes_[node.right].box.squaredExteriorDistance(p);
      stack[depth++] = left_first ? node.right : node.left;
      stack[depth++] = left_first ? node.left : node.right;
      continue;
    }
    for (std::uint32_t i = node.left; i < node.left + node.count; ++i) {
      const Triangle& t = triangles_[i];
      const Vector3 k = nearest_on_triangle(p, t.a, t.b, t.c),
                    at = k[0] * t.a + k[1] * t.b + k[2] * t.c;
      if ((p - at).squaredNorm() >= best) continue;
      best = (p - at).squaredNorm();
      out = {std::sqrt(best), at, (t.b - t.a).cross(t.c - t.a).normalized(), t.index, k};
    }
  }
  return out;
}

/// Visits the triangles whose boxes' leaves meet the box of the segment.
template <class Visit>
void TriangleTree::near_segment(const Vector3& from, const Vector3& to, Visit&& visit) const {
  Eigen::AlignedBox3d box(from);
  box.extend(to);
  std::array<std::uint32_t, 64> stack{};
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (!node.box.intersects(box)) continue;
    if (node.count == 0) {
      stack[depth++] = node.left;
      stack[depth++] = node.right;
      continue;
    }
    for (std::uint32_t i = node.left; i < node.left + node.count; ++i) visit(triangles_[i]);
  }
}

void TriangleTree::hits(const Vector3& p, const Vector3& d, double length,
                        std::vector<SurfaceHit>& out) const {
  out.clear();
  if (nodes_.empty()) return;
  near_segment(p, p + length * d, [&](const Triangle& t) {
    const Vector3 e1 = t.b - t.a, e2 = t.c - t.a, h = d.cross(e2);
    const double det = e1.dot(h);
    if (std::abs(det) < 1e-18) return;
    const Vector3 s = p - t.a, k = s.cross(e1);
    const double u = s.dot(h) / det, v = d.dot(k) / det, along = e2.dot(k) / det;
    if (u < 0 || v < 0 || u + v > 1 || along < 0 || along > length) return;
    out.push_back({along, p + along * d, e1.cross(e2).normalized(), t.index, {1 - u - v, u, v}});
  });
  std::sort(out.begin(), out.end(),
            [](const SurfaceHit& a, const SurfaceHit& b) { return a.along < b.along; });
}

bool TriangleTree::contains(const Vector3& p) const {
  if (nodes_.empty() || !box_.contains(p)) return false;
  static const std::array<Vector3, 3> directions = {Vector3(0.5773, 0.5211, 0.6286).normalized(),
                                                    Vector3(-0.3141, 0.9021, -0.2947).normalized(),
                                                    Vector3(0.1129, -0.4423, -0.8897).normalized()};
  int votes = 0;
  for (const Vector3& d : directions) {
    const Vector3 q = p + d * (2 * box_.diagonal().norm());
    int crossings = 0;
    near_segment(p, q, [&](const Triangle& t) { crossings += crosses(p, q, t.a, t.b, t.c); });
    votes += crossings & 1;
  }
  return votes >= 2;
}

}  // namespace handsel::grasp_planner
