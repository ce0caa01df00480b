// SPDX-License-Identifier: Apache-2.0
// Exact touch tests of capsules with a triangle mesh: a tree of boxes over the triangles. Closed
// forms, no solver.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/shape.hpp"

namespace handsel::grasp_planner {

/// Where a ray meets the surface.
struct SurfaceHit {
  double along{};  ///< from the ray's start [m]
  /// Of its triangle, by its orientation.
  Vector3 position{Vector3::Zero()}, normal{Vector3::UnitZ()};
  std::uint32_t triangle{};              ///< index into the triangles of the mesh
  Vector3 barycentric{Vector3::Zero()};  ///< weights of the three corners of the triangle, sum 1
};

class TriangleTree {
 public:
  TriangleTree() = default;
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Whether some triangle is nearer than `radius` to the segment.
  bool nearer_than(const Vector3& a, const Vector3& b, double radius) const;
  /// Distance of the segment to the surface [m]; `limit` when it is farther than that.
  double distance(const Vector3& a, const Vector3& b, double limit) const;
  /// The surface point nearest to `p`; `along` is its distance. The tree must not be empty.
  SurfaceHit nearest(const Vector3& p) const;
  /// Inside a closed mesh: most of three rays cross it an odd number of times.
  bool contains(const Vector3& p) const;
  /// All places where the ray from `p` along the unit vector `d` meets the surface within
  /// `length` [m], nearest first.
  void hits(const Vector3& p, const Vector3& d, double length, std::vector<SurfaceHit>& out) const;
  /// Returns the axis-aligned box around all triangles [m].
  const Eigen::AlignedBox3d& box() const { return box_; }

 private:
  template <class Visit>
  void near_segment(const Vector3& from, const Vector3& to, Visit&& visit) const;

  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t left{}, right{};  // count > 0: leaf with triangles [left, left + count)
    std::uint32_t count{};
  };
  struct Triangle {
    Vector3 a, b, c;
    std::uint32_t index{};
  };
  std::uint32_t build(std::size_t begin, std::size_t end);
  double search(const Vector3& a, const Vector3& b, double limit, bool first_hit) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
  Eigen::AlignedBox3d box_;
};

}  // namespace handsel::grasp_planner
