// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/path/broken_line.hpp"

#include <algorithm>
#include <limits>

namespace handsel {

namespace {
constexpr double kSame = 1e-6;  // [rad]
}

std::vector<Eigen::VectorXd> remainder(const std::vector<Eigen::VectorXd>& path,
                                       const Eigen::VectorXd& q, double reach) {
  if (path.size() < 2 || path.front().size() != q.size()) return {};
  double min_distance = std::numeric_limits<double>::infinity();
  std::size_t next = 0;
  bool at_end = false;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::VectorXd edge = path[i] - path[i - 1];
    const double ratio =
        edge.squaredNorm() > 0
            ? std::clamp((q - path[i - 1]).dot(edge) / edge.squaredNorm(), 0.0, 1.0)
            : 0.0;
    const double distance = (path[i - 1] + ratio * edge - q).lpNorm<Eigen::Infinity>();
    if (distance >= min_distance) continue;
    min_distance = distance;
    next = ratio == 1.0 ? i + 1 : i;
    at_end = next == path.size();
  }
  if (min_distance > reach || (at_end && (path.back() - q).lpNorm<Eigen::Infinity>() < kSame))
    return {};
  if (at_end) --next;
  std::vector<Eigen::VectorXd> rest = {q};
  for (std::size_t i = next; i < path.size(); ++i)
    if ((path[i] - rest.back()).lpNorm<Eigen::Infinity>() > kSame) rest.push_back(path[i]);
  if (rest.size() < 2) return {};
  rest.back() = path.back();
  return rest;
}

}  // namespace handsel
