#include "components/costmap/comfort_volume.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::costmap {

ComfortVolume::ComfortVolume(const ArmSize& arm, double resolution)
    : arm_(arm),
      resolution_(resolution),
      half_(static_cast<int>(std::ceil((arm.upper + arm.fore) / resolution)) + 1),
      size_(2 * half_ + 1) {
  values_.reserve(static_cast<std::size_t>(size_) * size_ * size_);
  for (int k = -half_; k <= half_; ++k)
    for (int j = -half_; j <= half_; ++j)
      for (int i = -half_; i <= half_; ++i) values_.push_back(static_cast<float>(arm_comfort_cost(arm, resolution * Vector3(i, j, k))));
}

bool ComfortVolume::suits(const ArmSize& arm, double tolerance) const {
  return size_ > 0 && std::abs(arm.upper - arm_.upper) < tolerance && std::abs(arm.fore - arm_.fore) < tolerance;
}

double ComfortVolume::cost(const Vector3& p_arm) const {
  const Vector3 cell = p_arm / resolution_ + Vector3::Constant(half_);
  const Eigen::Vector3i low = cell.array().floor().cast<int>();
  if ((low.array() < 0).any() || (low.array() >= size_ - 1).any()) return 1.0;
  const Vector3 f = cell - low.cast<double>();
  double sum = 0, weight = 0;
  int reachable = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int a = corner & 1, b = (corner >> 1) & 1, c = corner >> 2;
    const float value = at(low.x() + a, low.y() + b, low.z() + c);
    if (value >= 1.0F) continue;
    const double w = (a ? f.x() : 1 - f.x()) * (b ? f.y() : 1 - f.y()) * (c ? f.z() : 1 - f.z());
    ++reachable;
    weight += w;
    sum += w * value;
  }
  return weight > 0.5 && reachable > 0 ? sum / weight : 1.0;
}

}  // namespace handsel::costmap
