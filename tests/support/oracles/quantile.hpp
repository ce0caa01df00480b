// SPDX-License-Identifier: Apache-2.0
// Quantiles of measured times.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace handsel::test {

/// Returns the quantile `ratio` of times in seconds, in [ms]; 0 without times.
inline double quantile_ms(std::vector<double> times, double ratio) {
  if (times.empty()) return 0;
  std::sort(times.begin(), times.end());
  return 1e3 * times[std::min(times.size() - 1,
                              static_cast<std::size_t>(ratio * static_cast<double>(times.size())))];
}

}  // namespace handsel::test
