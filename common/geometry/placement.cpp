// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <LinearMath/btConvexHullComputer.h>

namespace handsel {
namespace {

constexpr double kSameNormal = 0.99985;  // cosine of one degree

struct Face {
  Vector3 normal;  // outward
  double area{};
  std::vector<Vector3> corners;
};

std::vector<Face> hull_faces(const TriangleMesh& mesh) {
  std::vector<btVector3> points;
  for (const Vector3& p : mesh.vertices) points.emplace_back(p.x(), p.y(), p.z());
  btConvexHullComputer hull;
  hull.compute(points.empty() ? nullptr : &points[0].m_floats[0], sizeof(btVector3),
               static_cast<int>(points.size()), 0, 0);
  std::vector<Face> out;
  for (int i = 0; i < hull.faces.size(); ++i) {
    Face face;
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[i]];
    const auto* edge = first;
    do {
      const btVector3& v = hull.vertices[edge->getSourceVertex()];
      face.corners.emplace_back(v.x(), v.y(), v.z());
      edge = edge->getNextEdgeOfFace();
    } while (edge != first);
    Vector3 sum = Vector3::Zero();
    for (std::size_t k = 2; k < face.corners.size(); ++k)
      sum += 0.5 * (face.corners[k - 1] - face.corners[0]).cross(face.corners[k] - face.corners[0]);
    face.area = sum.norm();
    if (!(face.area > 0)) continue;
    face.normal = sum / face.area;
    out.push_back(std::move(face));
  }
  // Bullet does not define the order of corners: outward is away from the centre.
  Vector3 middle = Vector3::Zero();
  for (const Face& face : out) middle += face.corners[0] / static_cast<double>(out.size());
  for (Face& face : out)
    if (face.normal.dot(face.corners[0] - middle) < 0) face.normal = -face.normal;
  std::sort(out.begin(), out.end(), [](const Face& a, const Face& b) { return a.area > b.area; });
  return out;
}

/// Returns the corners of the convex polygon around points in a plane, counter-clockwise.
std::vector<Eigen::Vector2d> around(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  const auto turn = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                       const Eigen::Vector2d& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  };
  std::vector<Eigen::Vector2d> out;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = out.size();
    for (const Eigen::Vector2d& p : points) {
      while (out.size() >= begin + 2 && turn(out[out.size() - 2], out.back(), p) <= 0)
        out.pop_back();
      out.push_back(p);
    }
    out.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return out;
}

}  // namespace

MassProperties mass_properties(const TriangleMesh& mesh) {
  MassProperties out;
  if (mesh.vertices.empty()) return out;
  const Vector3 o = mesh.vertices[0];
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // integral of p p^T
  Vector3 first = Vector3::Zero();
  for (const auto& t : mesh.triangles) {
    const Vector3 a = mesh.vertices[static_cast<std::size_t>(t[0])] - o,
                  b = mesh.vertices[static_cast<std::size_t>(t[1])] - o,
                  c = mesh.vertices[static_cast<std::size_t>(t[2])] - o;
    const double volume = a.dot(b.cross(c)) / 6;
    const Vector3 sum = a + b + c;
    out.volume += volume;
    first += volume / 4 * sum;
    second += volume / 20 *
              (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  if (!(out.volume > 0)) return out;
  const Vector3 com = first / out.volume;
  out.com = o + com;
  const Eigen::Matrix3d about_com = second / out.volume - com * com.transpose();
  out.inertia_per_mass = about_com.trace() * Eigen::Matrix3d::Identity() - about_com;
  return out;
}

std::vector<Placement> stable_placements(const TriangleMesh& mesh, const Vector3& com,
                                         double min_tipping) {
  std::vector<Placement> out;
  std::vector<Face> faces = hull_faces(mesh);
  std::vector<bool> taken(faces.size(), false);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (taken[i]) continue;
    const Vector3 down = faces[i].normal;
    Placement placement;
    const Eigen::Matrix3d R =
        Eigen::Quaterniond::FromTwoVectors(down, -Vector3::UnitZ()).toRotationMatrix();
    std::vector<Eigen::Vector2d> corners;
    placement.height = down.dot(faces[i].corners[0] - com);
    for (std::size_t k = i; k < faces.size(); ++k) {
      if (taken[k] || !(faces[k].normal.dot(down) > kSameNormal)) continue;
      taken[k] = true;
      placement.area += faces[k].area;
      for (const Vector3& p : faces[k].corners) corners.push_back((R * (p - com)).head<2>());
    }
    if (!(placement.height > 0)) continue;
    const std::vector<Eigen::Vector2d> polygon = around(corners);
    placement.margin = polygon.size() < 3 ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d &a = polygon[k],
                            along = (polygon[(k + 1) % polygon.size()] - a).normalized();
      placement.margin = std::min(placement.margin, along.x() * -a.y() - along.y() * -a.x());
    }
    placement.tipping = std::atan2(placement.margin, placement.height);
    if (!(placement.tipping >= min_tipping)) continue;
    placement.T_support_object.linear() = R;
    placement.T_support_object.translation() = Vector3(0, 0, placement.height) - R * com;
    out.push_back(placement);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Placement& a, const Placement& b) { return a.tipping > b.tipping; });
  return out;
}

}  // namespace handsel
