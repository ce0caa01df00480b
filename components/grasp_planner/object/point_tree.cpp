// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/object/point_tree.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace handsel::grasp_planner {

PointTree::PointTree(const std::vector<Vector3>& points) : points_(points) {
  if (points_.empty()) return;
  std::vector<std::uint32_t> order(points_.size());
  std::iota(order.begin(), order.end(), 0U);
  nodes_.reserve(2 * points_.size());
  build(order, 0, order.size());
  box_ = nodes_.front().box;
}

std::uint32_t PointTree::build(std::vector<std::uint32_t>& order, std::size_t begin,
                               std::size_t end) {
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  for (std::size_t i = begin; i < end; ++i) box.extend(points_[order[i]]);
  nodes_[id].box = box;
  if (end - begin == 1) {
    nodes_[id].left = order[begin];
    return id;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const double middle = box.center()[axis];
  const auto first = order.begin() + static_cast<std::ptrdiff_t>(begin),
             last = order.begin() + static_cast<std::ptrdiff_t>(end);
  auto cut = std::stable_partition(first, last,
                                   [&](std::uint32_t i) { return points_[i][axis] <= middle; });
  if (cut == first || cut == last) cut = first + (last - first) / 2;
  const auto split = static_cast<std::size_t>(cut - order.begin());
  const std::uint32_t left = build(order, begin, split);
  const std::uint32_t right = build(order, split, end);
  nodes_[id].left = left;
  nodes_[id].right = right;
  return id;
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
    if (node.right == 0) {
      out.push_back(node.left);
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
