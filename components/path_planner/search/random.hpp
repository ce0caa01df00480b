// SPDX-License-Identifier: Apache-2.0
// Random numbers that depend only on the seed, not on the machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "common/geometry/pose.hpp"

namespace handsel::path_planner {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed * 0x9e3779b97f4a7c15ULL + 1) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }  ///< [0, 1)
  /// Returns a number uniform in [low, high).
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// Returns 64 uniform bits.
  std::uint64_t bits() { return engine_(); }
  /// Returns a number of the standard normal distribution (Box and Muller).
  double normal() { return std::sqrt(-2 * std::log(1 - unit())) * std::cos(2 * M_PI * unit()); }
  /// Returns a vector uniform in the box between two corners.
  Vector within(const Vector& low, const Vector& high) {
    Vector q(low.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = between(low[i], high[i]);
    return q;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace handsel::path_planner
