// SPDX-License-Identifier: Apache-2.0
// A layer that an external process adds to the cost map.
#pragma once

#include <string>

#include "common/messages/world.hpp"

namespace handsel::test {

/// Over the box `low` to `high` (world, m) at 5 cm: `value` within the inner box, 0 elsewhere.
inline Costmap box_layer(const std::string& name, const Vector3& low, const Vector3& high,
                         const Vector3& inner_low, const Vector3& inner_high, std::uint8_t value,
                         double weight) {
  Costmap map;
  map.layer = name;
  map.origin = low;
  map.resolution = 0.05;
  const Eigen::Array3i size = ((high - low) / map.resolution).array().round().cast<int>() + 1;
  map.nx = static_cast<std::uint32_t>(size.x());
  map.ny = static_cast<std::uint32_t>(size.y());
  map.nz = static_cast<std::uint32_t>(size.z());
  map.weight = weight;
  for (int k = 0; k < size.z(); ++k)
    for (int j = 0; j < size.y(); ++j)
      for (int i = 0; i < size.x(); ++i) {
        const Vector3 p = low + map.resolution * Vector3(i, j, k);
        const bool inside =
            (p.array() >= inner_low.array()).all() && (p.array() <= inner_high.array()).all();
        map.values.push_back(inside ? value : 0);
      }
  return map;
}

}  // namespace handsel::test
