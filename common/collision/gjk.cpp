// SPDX-License-Identifier: Apache-2.0
#include "common/collision/gjk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace handsel {
namespace {

constexpr double kTolerance = 1e-10;
constexpr int kMaxIterations = 256;

double sign(double x) { return x < 0 ? -1.0 : 1.0; }

Vector3 local_support(const ConvexCore& core, const Vector3& d) {
  switch (core.kind) {
    case ConvexCore::Kind::point:
      return Vector3::Zero();
    case ConvexCore::Kind::segment:
      return {0, 0, sign(d.z()) * core.half.z()};
    case ConvexCore::Kind::triangle: {
      const double a = d.dot(core.corners[0]), b = d.dot(core.corners[1]),
                   c = d.dot(core.corners[2]);
      return core.corners[a >= b && a >= c ? 0 : b >= c ? 1 : 2];
    }
    case ConvexCore::Kind::box:
      return {sign(d.x()) * core.half.x(), sign(d.y()) * core.half.y(),
              sign(d.z()) * core.half.z()};
    case ConvexCore::Kind::cylinder: {
      const double norm = std::hypot(d.x(), d.y());
      const double scale = norm > 1e-14 ? core.half.x() / norm : 0.0;
      return {d.x() * scale, d.y() * scale, sign(d.z()) * core.half.z()};
    }
  }
  return Vector3::Zero();
}

Vector3 support(const ConvexCore& core, const Vector3& d) {
  return core.T_world_core * local_support(core, core.T_world_core.linear().transpose() * d);
}

struct Simplex {
  std::array<Vector3, 4> p;     // point of a minus point of b
  std::array<Vector3, 4> on_a;  // the point of a
  int size{};
  void keep(std::initializer_list<int> which) {
    std::array<Vector3, 4> kept, kept_on_a;
    int n = 0;
    for (int i : which) {
      kept[n] = p[i];
      kept_on_a[n++] = on_a[i];
    }
    p = kept;
    on_a = kept_on_a;
    size = n;
  }
  void add(const Vector3& point_a, const Vector3& point_b) {
    on_a[size] = point_a;
    p[size++] = point_a - point_b;
  }
  /// Returns the point of a that belongs to the point v of the simplex (at most a triangle).
  Vector3 point_of_a(const Vector3& v) const {
    if (size == 1) return on_a[0];
    const Vector3 e = p[1] - p[0], r = v - p[0];
    const double ee = e.squaredNorm(), er = e.dot(r);
    if (size == 2) return on_a[0] + (ee > 0 ? er / ee : 0.0) * (on_a[1] - on_a[0]);
    const Vector3 f = p[2] - p[0];
    const double ff = f.squaredNorm(), ef = e.dot(f), fr = f.dot(r), det = ee * ff - ef * ef;
    if (!(det > 0)) return on_a[0];
    return on_a[0] + (ff * er - ef * fr) / det * (on_a[1] - on_a[0]) +
           (ee * fr - ef * er) / det * (on_a[2] - on_a[0]);
  }
};

Vector3 nearest_on_segment(Simplex& s) {
  const Vector3 d = s.p[1] - s.p[0];
  const double length2 = d.squaredNorm();
  const double t = length2 > 0 ? -s.p[0].dot(d) / length2 : 0.0;
  if (t <= 0) {
    s.keep({0});
    return s.p[0];
  }
  if (t >= 1) {
    s.keep({1});
    return s.p[0];
  }
  return s.p[0] + t * d;
}

/// Nearest point of triangle (i, j, k) to the origin, with the vertices of its feature.
struct OnTriangle {
  Vector3 point;
  std::array<int, 3> used{};
  int count{};
};

OnTriangle nearest_on_triangle(const Simplex& s, int i, int j, int k) {
  const Vector3 &a = s.p[i], &b = s.p[j], &c = s.p[k];
  const Vector3 ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return {a, {i}, 1};
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return {b, {j}, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + d1 / (d1 - d3) * ab, {i, j}, 2};
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return {c, {k}, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + d2 / (d2 - d6) * ac, {i, k}, 2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), {j, k}, 2};
  const double sum = va + vb + vc;
  if (!(std::abs(sum) > 0)) return {a, {i}, 1};
  return {a + ab * (vb / sum) + ac * (vc / sum), {i, j, k}, 3};
}

void keep(Simplex& s, const OnTriangle& t) {
  if (t.count == 1) s.keep({t.used[0]});
  if (t.count == 2) s.keep({t.used[0], t.used[1]});
  if (t.count == 3) s.keep({t.used[0], t.used[1], t.used[2]});
}

/// Reduces the simplex to the face nearest to the origin; size stays 4 when the origin is inside.
Vector3 reduce(Simplex& s) {
  if (s.size == 1) return s.p[0];
  if (s.size == 2) return nearest_on_segment(s);
  if (s.size == 3) {
    const OnTriangle t = nearest_on_triangle(s, 0, 1, 2);
    keep(s, t);
    return t.point;
  }
  static constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
  bool outside = false;
  OnTriangle best;
  double best2 = std::numeric_limits<double>::infinity();
  for (const auto& f : kFaces) {
    const Vector3 n = (s.p[f[1]] - s.p[f[0]]).cross(s.p[f[2]] - s.p[f[0]]);
    const double to_origin = -n.dot(s.p[f[0]]), to_fourth = n.dot(s.p[f[3]] - s.p[f[0]]);
    if (to_origin * to_fourth > 0) continue;
    outside = true;
    const OnTriangle t = nearest_on_triangle(s, f[0], f[1], f[2]);
    if (t.point.squaredNorm() < best2) {
      best2 = t.point.squaredNorm();
      best = t;
    }
  }
  if (!outside) return Vector3::Zero();
  keep(s, best);
  return best.point;
}

/// Returns the distance of the cores, `v` apart at first; once it surely exceeds `enough`, returns
/// a lower bound.
double core_distance(const ConvexCore& a, const ConvexCore& b, double enough, Simplex& s,
                     Vector3& v) {
  v = a.T_world_core.translation() - b.T_world_core.translation();
  if (v.squaredNorm() < 1e-24) v = Vector3::UnitX();
  s.add(support(a, -v), support(b, v));
  v = s.p[0];
  double best = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double norm = v.norm();
    if (norm < 1e-12) return 0.0;
    best = std::min(best, norm);
    const Vector3 w_a = support(a, -v), w_b = support(b, v), w = w_a - w_b;
    const double bound = v.dot(w) / norm;
    if (bound > enough) return bound;
    if (norm - bound <= kTolerance * std::max(1.0, norm)) return norm;
    for (int i = 0; i < s.size; ++i)
      if ((s.p[i] - w).squaredNorm() < 1e-28) return norm;
    s.add(w_a, w_b);
    v = reduce(s);
    if (s.size == 4) return 0.0;
  }
  return best;
}

}  // namespace

ConvexCore convex_core(const Shape& shape, const Pose& T_world_shape) {
  ConvexCore core;
  core.T_world_core = T_world_shape;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    core.margin = sphere->radius;
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    core.kind = ConvexCore::Kind::segment;
    core.half.z() = 0.5 * capsule->length;
    core.margin = capsule->radius;
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    core.kind = ConvexCore::Kind::box;
    core.half = 0.5 * box->size;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    core.kind = ConvexCore::Kind::cylinder;
    core.half = Vector3(cylinder->radius, cylinder->radius, 0.5 * cylinder->length);
  } else {
    const auto& mesh = *std::get<MeshPtr>(shape);
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vector3& p : mesh.vertices) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    core.kind = ConvexCore::Kind::box;
    core.half = 0.5 * (high - low);
    core.T_world_core = T_world_shape * Eigen::Translation3d(0.5 * (high + low));
  }
  return core;
}

double convex_distance(const ConvexCore& a, const ConvexCore& b, Vector3* on_a, Vector3* on_b) {
  Simplex s;
  Vector3 v;
  const double apart = core_distance(a, b, std::numeric_limits<double>::infinity(), s, v),
               distance = apart - a.margin - b.margin;
  if (distance <= 0) return 0.0;
  if (on_a != nullptr || on_b != nullptr) {
    const Vector3 point = s.point_of_a(v), normal = v / v.norm();
    if (on_a != nullptr) *on_a = point - a.margin * normal;
    if (on_b != nullptr) *on_b = point - v + b.margin * normal;
  }
  return distance;
}

bool convex_touch(const ConvexCore& a, const ConvexCore& b) {
  const double reach = a.margin + b.margin;
  Simplex s;
  Vector3 v;
  return core_distance(a, b, reach, s, v) <= reach;
}

}  // namespace handsel
