// SPDX-License-Identifier: Apache-2.0
#include "components/costmap/comfort_volume.hpp"

#include <cmath>

namespace handsel::costmap {

ComfortVolume::ComfortVolume(const ArmSize& arm, double resolution)
    : arm_(arm),
      resolution_(resolution),
      half_(static_cast<int>(std::ceil((arm.upper + arm.fore) / resolution)) + 1),
      size_(2 * half_ + 1) {
  points_.reserve(static_cast<std::size_t>(size_) * size_ * size_);
  for (int k = -half_; k <= half_; ++k)
    for (int j = -half_; j <= half_; ++j)
      for (int i = -half_; i <= half_; ++i) {
        const auto cost = static_cast<float>(arm_comfort_cost(arm, resolution * Vector3(i, j, k)));
        points_.push_back(cost < 1 ? Point{cost, 1} : Point{0, 0});
      }
}

bool ComfortVolume::suits(const ArmSize& arm, double tolerance) const {
  return size_ > 0 && std::abs(arm.upper - arm_.upper) < tolerance &&
         std::abs(arm.fore - arm_.fore) < tolerance;
}

double ComfortVolume::cost(const Vector3& p_arm) const {
  const Eigen::Array3f cell =
      (p_arm / resolution_).cast<float>().array() + static_cast<float>(half_);
  if (!((cell >= 0).all() && (cell < static_cast<float>(size_ - 1)).all())) return 1.0;
  const Eigen::Array3i low = cell.cast<int>();
  const Eigen::Array3f f = cell - low.cast<float>();
  const Point* first =
      points_.data() + (static_cast<std::size_t>(low.z()) * size_ + low.y()) * size_ + low.x();
  const auto pair = [&](std::size_t offset) {
    return Eigen::Map<const Eigen::Array4f>(&first[offset].cost);
  };  // along x
  const std::size_t row = size_, plane = row * row;
  const Eigen::Array4f lower = (1 - f.y()) * pair(0) + f.y() * pair(row),
                       upper = (1 - f.y()) * pair(plane) + f.y() * pair(plane + row);
  const Eigen::Array4f both = (1 - f.z()) * lower + f.z() * upper;
  const float sum = (1 - f.x()) * both[0] + f.x() * both[2],
              weight = (1 - f.x()) * both[1] + f.x() * both[3];
  return weight > 0.5f ? sum / weight : 1.0;
}

}  // namespace handsel::costmap
