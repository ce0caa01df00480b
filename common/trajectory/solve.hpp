// Several axes from state to state, ending together (chapter section 4.3.2; blocked durations and the blend: min_time.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/trajectory/trajectory.hpp"

namespace handsel {

enum class Sync {
  time,  ///< all axes end together, as soon as every one can
  none,  ///< every axis as fast as it can; those that end early must end at rest, and wait
};

struct Solution {
  Trajectory trajectory;
  std::string reason;                 ///< why there is no trajectory; empty when there is
  std::vector<double> min_durations;  ///< of each axis alone [s]
  double excess{};                    ///< beyond the limits, only when an imposed duration forced the three-segment method; else 0
  bool ok() const { return reason.empty(); }
};

/// `imposed`: duration wanted [s]. Below the minimum of an axis it is refused; where an axis cannot keep its limits for exactly that
/// duration, that axis gets three segments and `excess` says by how much they break the limits.
Solution solve(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits, Sync sync = Sync::time,
               std::optional<double> imposed = std::nullopt);

}  // namespace handsel
