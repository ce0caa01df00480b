// SPDX-License-Identifier: Apache-2.0
// Hierarchy of axis-aligned boxes over points, split along the longer side down to a few points
// (chapter section 3.2.4, which splits down to single points).
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "common/geometry/pose.hpp"

namespace handsel::grasp_planner {

class PointTree {
 public:
  PointTree() = default;
  explicit PointTree(const std::vector<Vector3>& points);

  /// Appends the indices of the points inside the ball (boundary included), in the order of the
  /// tree.
  void inside_ball(const Vector3& centre, double radius, std::vector<std::uint32_t>& out) const;
  /// The nodes' boxes at a depth of the tree (0: the root's), leaves above it included.
  std::vector<Eigen::AlignedBox3d> boxes(int depth) const;
  /// Returns the axis-aligned box around all points; empty without points.
  const Eigen::AlignedBox3d& box() const { return box_; }
  /// Returns the number of points.
  std::size_t size() const { return points_.size(); }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t begin{}, end{};   // of its points in points_ and index_
    std::uint32_t left{}, right{};  // right == 0: leaf
  };
  /// Appends the node of points `begin` to `end` and those below; returns its index.
  std::uint32_t build(const std::vector<Vector3>& points, std::uint32_t begin, std::uint32_t end);
  /// Orders points by the middle of the longer side of their box; returns where the second half
  /// begins.
  std::uint32_t split(const std::vector<Vector3>& points, const Eigen::AlignedBox3d& box,
                      std::uint32_t begin, std::uint32_t end);

  std::vector<Vector3> points_;       // in the order of the tree
  std::vector<std::uint32_t> index_;  // of each of them, as given
  std::vector<Node> nodes_;
  Eigen::AlignedBox3d box_;
};

}  // namespace handsel::grasp_planner
