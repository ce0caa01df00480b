// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/object/point_tree.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace handsel::grasp_planner {

namespace {

constexpr std::uint32_t kPointsOfLeaf = 8;

// Returns whether a ball, given by its squared radius, contains a box.
bool ball_contains(const Vector3& centre, double squared_radius, const Eigen::AlignedBox3d& box) {
  const Vector3 farthest = (centre - box.min()).cwiseMax(box.max() - centre);
  return farthest.squaredNorm() <= squared_radius;
}

}  // namespace

PointTree::PointTree(const std::vector<Vector3>& points) {
  if (points.empty()) return;
  index_.resize(points.size());
  std::iota(index_.begin(), index_.end(), 0U);
  nodes_.reserve(points.size());
  build(points, 0, static_cast<std::uint32_t>(points.size()));
  points_.reserve(points.size());
  for (const std::uint32_t i : index_) points_.push_back(points[i]);
  box_ = nodes_.front().box;
}

std::uint32_t PointTree::build(const std::vector<Vector3>& points, std::uint32_t begin,
                               std::uint32_t end) {
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  for (std::uint32_t i = begin; i < end; ++i) box.extend(points[index_[i]]);
  nodes_[id].box = box;
  nodes_[id].begin = begin;
  nodes_[id].end = end;
  if (end - begin == 1) return id;
  const std::uint32_t middle = split(points, box, begin, end);
  const std::uint32_t left = build(points, begin, middle);
  const std::uint32_t right = build(points, middle, end);
  if (end - begin <= kPointsOfLeaf) {  // its points are in the order of the nodes below, which go
    nodes_.resize(id + 1);
    return id;
  }
  nodes_[id].left = left;
  nodes_[id].right = right;
  return id;
}

std::uint32_t PointTree::split(const std::vector<Vector3>& points, const Eigen::AlignedBox3d& box,
                               std::uint32_t begin, std::uint32_t end) {
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const double middle = box.center()[axis];
  const auto first = index_.begin() + begin, last = index_.begin() + end;
  auto cut = std::stable_partition(first, last,
                                   [&](std::uint32_t i) { return points[i][axis] <= middle; });
  if (cut == first || cut == last) cut = first + (last - first) / 2;
  return static_cast<std::uint32_t>(cut - index_.begin());
}

void PointTree::inside_ball(const Vector3& centre, double radius,
                            std::vector<std::uint32_t>& out) const {
  if (nodes_.empty()) return;
  const double limit = radius * radius;
  std::array<std::uint32_t, 64> small{};
  std::vector<std::uint32_t> large;
  std::size_t depth = 0;
  const auto push = [&](std::uint32_t n) {
    depth < small.size() ? static_cast<void>(small[depth++] = n) : large.push_back(n);
  };
  push(0);
  while (depth > 0 || !large.empty()) {
    std::uint32_t id = 0;
    if (!large.empty()) {
      id = large.back();
      large.pop_back();
    } else {
      id = small[--depth];
    }
    const Node& node = nodes_[id];
    if (node.box.squaredExteriorDistance(centre) > limit) continue;
    if (ball_contains(centre, limit, node.box)) {
      out.insert(out.end(), index_.begin() + node.begin, index_.begin() + node.end);
    } else if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        if ((points_[i] - centre).squaredNorm() <= limit) out.push_back(index_[i]);
    } else {
      push(node.right);
      push(node.left);
    }
  }
}

std::vector<Eigen::AlignedBox3d> PointTree::boxes(int depth) const {
  std::vector<std::uint32_t> level;
  if (!nodes_.empty()) level.push_back(0);
  for (; depth > 0; --depth) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t id : level) {
      const Node& node = nodes_[id];
      if (node.right == 0) {
        next.push_back(id);
      } else {
        next.insert(next.end(), {node.left, node.right});
      }
    }
    level = std::move(next);
  }
  std::vector<Eigen::AlignedBox3d> out;
  out.reserve(level.size());
  for (const std::uint32_t id : level) out.push_back(nodes_[id].box);
  return out;
}

}  // namespace handsel::grasp_planner
