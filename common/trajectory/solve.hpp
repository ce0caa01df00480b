// SPDX-License-Identifier: Apache-2.0
// Several axes from state to state, ending together (chapter section 4.3.2; blocked durations and
// the blend: min_time.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/trajectory/batch/kernels.hpp"
#include "common/trajectory/min_time.hpp"

namespace handsel {

enum class Sync {
  time,  ///< all axes end together, as soon as every one can
  none,  ///< every axis as fast as it can; those that end early must end at rest, and wait
};

struct Solution {
  Trajectory trajectory;              ///< of all axes; without axes when there is a reason
  std::string reason;                 ///< why there is no trajectory; empty when there is
  std::vector<double> min_durations;  ///< of each axis alone [s]
  /// Beyond the limits, only when an imposed duration forced the three-segment method; else 0.
  double excess{};
  /// Returns whether there is a trajectory.
  bool ok() const { return reason.empty(); }
};

/// Several problems of equally many axes at once, each ending together, axes side by side in SIMD
/// registers: for a planner that weighs candidates. Allocates at construction only.
class SynchronisedBatch {
 public:
  SynchronisedBatch(int axes, int problems);
  /// Problem p, axis i is entry p * axes + i of each array. Returns how many of the first `count`
  /// problems are solved.
  int solve(const detail::AxisBatchInput& in, int count) noexcept;

  /// Of a problem that was not solved only outcome() and axis() are to be used: what failed and
  /// where.
  AxisOutcome outcome(int problem) const noexcept {
    return problems_[static_cast<std::size_t>(problem)].outcome;
  }
  /// Returns the axis at which the problem failed; without meaning when its outcome is ok.
  int axis(int problem) const noexcept { return problems_[static_cast<std::size_t>(problem)].axis; }
  /// Returns the duration that all axes of a solved problem have [s].
  double duration(int problem) const noexcept {
    return problems_[static_cast<std::size_t>(problem)].duration;
  }
  /// Returns the minimum duration of one axis alone [s].
  double minimum(int problem, int axis) const noexcept { return minima_[entry(problem, axis)]; }
  /// Returns the motion of one axis of a solved problem; valid until the next solve().
  const AxisProfile& profile(int problem, int axis) const noexcept {
    return profiles_[entry(problem, axis)];
  }

 private:
  struct Problem {
    double duration{};
    AxisOutcome outcome{AxisOutcome::ok};
    int axis{};
    bool open{};
  };
  std::size_t entry(int problem, int axis) const noexcept {
    return static_cast<std::size_t>(problem) * static_cast<std::size_t>(axes_) +
           static_cast<std::size_t>(axis);
  }
  void take_over(const detail::AxisBatchInput& in, int entry) noexcept;
  void find_durations(int count) noexcept;
  void write_profiles(int total) noexcept;

  int axes_;
  std::vector<Problem> problems_;
  std::vector<detail::AxisBatch> blocks_;
  std::vector<std::uint32_t> odd_;  // of each block, the axes solved one by one
  std::vector<AxisProblem> slow_;   // for those
  std::vector<double> minima_, durations_;
  std::vector<AxisProfile> profiles_;
};

/// One problem, for a cycle: allocates at construction only.
class SynchronisedAxes {
 public:
  explicit SynchronisedAxes(int axes) : batch_(axes, 1), axes_(axes) {}
  /// On false `outcome()` and `axis()` say what failed and where; the profiles are not to be used.
  bool solve(const MotionState3& from, const MotionState3& to,
             const KinematicLimits& limits) noexcept;
  /// Returns the duration that all axes have [s].
  double duration() const noexcept { return batch_.duration(0); }
  /// Returns the minimum duration of one axis alone [s].
  double minimum(int axis) const noexcept { return batch_.minimum(0, axis); }
  /// Returns the motion of one axis; valid until the next solve().
  const AxisProfile& profile(int axis) const noexcept { return batch_.profile(0, axis); }
  /// Returns what failed, wrong_size also for vectors that do not have as many elements as axes.
  AxisOutcome outcome() const noexcept {
    return wrong_size_ ? AxisOutcome::wrong_size : batch_.outcome(0);
  }
  /// Returns the axis that failed; without meaning for ok and wrong_size.
  int axis() const noexcept { return batch_.axis(0); }

 private:
  SynchronisedBatch batch_;
  int axes_;
  bool wrong_size_{};
};

/// `imposed`: duration wanted [s]. Below the minimum of an axis it is refused; where an axis cannot
/// keep its limits for exactly that duration, that axis gets three segments and `excess` says by
/// how much they break the limits.
Solution solve(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits,
               Sync sync = Sync::time, std::optional<double> imposed = std::nullopt);

}  // namespace handsel
