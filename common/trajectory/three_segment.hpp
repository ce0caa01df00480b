// SPDX-License-Identifier: Apache-2.0
// The three-segment method (chapter section 4.3.3): a motion of imposed duration between any two
// states. It bounds nothing: look at excess.
#pragma once

#include <array>

#include "common/trajectory/min_time.hpp"

namespace handsel {

/// Three segments of duration / 3. Needs duration > 0.
std::array<Segment, 3> three_segment(const AxisState& from, const AxisState& to,
                                     double duration) noexcept;

/// By how much the segments go beyond the limits: largest of |v|/V, |a|/A, |j|/J, minus 1
/// (negative: inside), on the exact extremes.
double excess(const AxisState& from, const Segment* segments, int count,
              const AxisLimits& limits) noexcept;

}  // namespace handsel
