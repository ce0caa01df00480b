// Several axes from state to state, ending together (chapter section 4.3.2; blocked durations and the blend: min_time.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/trajectory/min_time.hpp"

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

/// The same for a cycle: allocates at construction only.
class SynchronisedAxes {
 public:
  explicit SynchronisedAxes(int axes) : problems_(axes), profiles_(axes) {}
  /// All of size axes. On false `outcome()` and `axis()` say what failed and where; the profiles are not to be used.
  bool solve(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits) noexcept;
  double duration() const noexcept { return duration_; }
  double minimum(int axis) const noexcept { return problems_[axis].minimum(); }
  const AxisProfile& profile(int axis) const noexcept { return profiles_[axis]; }
  const AxisProblem& problem(int axis) const noexcept { return problems_[axis]; }
  AxisOutcome outcome() const noexcept { return outcome_; }
  int axis() const noexcept { return axis_; }

  /// The steps of solve, for callers that want something between: read the problems, find the least common duration, make the profiles.
  bool read(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits) noexcept;
  double least_common() const noexcept;

 private:
  std::vector<AxisProblem> problems_;
  std::vector<AxisProfile> profiles_;
  double duration_{};
  AxisOutcome outcome_{AxisOutcome::ok};
  int axis_{};
};

/// `imposed`: duration wanted [s]. Below the minimum of an axis it is refused; where an axis cannot keep its limits for exactly that
/// duration, that axis gets three segments and `excess` says by how much they break the limits.
Solution solve(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits, Sync sync = Sync::time,
               std::optional<double> imposed = std::nullopt);

}  // namespace handsel
