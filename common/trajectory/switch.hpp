// SPDX-License-Identifier: Apache-2.0
// From a state in motion onto another trajectory (chapter sections 2 and 4.3: trajectories modified
// on-line). Own method: a search over where to join, so that the end of the new trajectory is
// reached first.
//
// A motion of min time, all axes ending together, leads from the present state to a state of the
// other trajectory; of the places where it can be joined the one is taken from which its end is
// reached first. Velocity and acceleration are continuous, the limits hold exactly.
#pragma once

#include <limits>
#include <vector>

#include "common/trajectory/min_time.hpp"
#include "common/trajectory/path/segment_table.hpp"

namespace handsel {

enum class SwitchOutcome {
  ok,
  wrong_size,           ///< not as many axes as constructed for, or no trajectory
  not_finite,           ///< a number of the present state is NaN or infinite
  bad_limits,           ///< a limit is zero or negative
  start_beyond_limits,  ///< the present state cannot be left inside the limits
  /// Nowhere in the window can the new trajectory be joined inside the limits.
  nowhere,
  too_long,  ///< more segments than a TimeScaling has room for; never of plan()
  not_now,   ///< of TimeScaling only: its speed factor changes too fast; a later cycle may do
};
/// Returns the cause of a failure as a sentence without full stop, "" for ok.
const char* reason(SwitchOutcome) noexcept;

struct SwitchSettings {
  /// The new trajectory is joined at or after this, on its own time [s].
  double first{0.0};
  double last{std::numeric_limits<double>::infinity()};  ///< and not after this [s]
  /// The new trajectory runs already, its time is 0 now: it is met where it then is, as early as
  /// possible. After its end it is at rest there. `last` is not used.
  bool on_clock{};
  /// The connecting motion keeps limits / reserve, >= 1; where that fails, limits / sqrt(reserve),
  /// then the limits.
  double reserve{1.1};
  int tries{24};  ///< places tried before the best is refined
};

/// Returns whether the states differ by rounding only, at most 1e-11 in each value: no connecting
/// motion is needed. (Between states that differ by a little it may be a loop of a second.)
bool same_motion(const MotionState3&, const MotionState3&) noexcept;

/// For a cycle: allocates at construction only.
class TrajectorySwitch {
 public:
  TrajectorySwitch() : TrajectorySwitch(0) {}
  explicit TrajectorySwitch(int axes);

  /// Plans the connecting motion from `now` to a state of `next`. On anything but ok the functions
  /// below are not to be used.
  SwitchOutcome plan(const MotionState3& now, const SegmentTable& next,
                     const KinematicLimits& limits, const SwitchSettings&) noexcept;

  /// On the new trajectory's own time; beyond its end only on the clock [s].
  double joins_at() const noexcept { return join_; }
  double duration() const noexcept { return connect_; }  ///< of the connecting motion [s]
  int segments() const noexcept;                         ///< at most, of the connecting motion
  /// Adds the connecting motion, then the rest of `next`, which must be what was planned for.
  void add_to(SegmentTable& out, const SegmentTable& next) noexcept;

 private:
  double meeting(const MotionState3& now, const SegmentTable& next, const KinematicLimits& limits,
                 double t, double min_duration) noexcept;
  bool best_place(const MotionState3& now, const SegmentTable& next, const KinematicLimits& limits,
                  const SwitchSettings&) noexcept;
  bool earliest_meeting(const MotionState3& now, const SegmentTable& next,
                        const KinematicLimits& limits, const SwitchSettings&) noexcept;
  bool make_profiles(const MotionState3& now, const KinematicLimits& guard) noexcept;

  int n_;
  std::vector<AxisProblem> problems_;
  std::vector<AxisProfile> profiles_;
  std::vector<AxisState> start_;
  KinematicLimits reduced_;
  MotionState3 there_;
  Eigen::VectorXd jerk_;
  std::vector<int> at_;
  std::vector<double> left_;
  double join_{}, connect_{};
  int cursor_{};
};

/// solve_axis for a start that is already on a time-optimal motion to an end state in motion, as
/// when it is planned anew each tick. Such a motion is often the only one for its duration, and
/// rounding decides whether it is found; so limits wider by 1e-9, then 1e-7, are tried too, and
/// taken where the motion is then shorter by more than that could make it.
AxisOutcome replan_axis(const AxisState& from, const AxisState& to, const AxisLimits& limits,
                        AxisProfile& out) noexcept;

/// Adds the part of `from` from `begin` to `end` [s] to `out`; a row that is cut starts with the
/// state there. `state`: scratch memory for all axes. No allocation within the room of `out`.
void add_part(const SegmentTable& from, double begin, double end, SegmentTable& out,
              MotionState3& state) noexcept;

struct Switched {
  /// From the present state: the connecting motion, then the rest of the new trajectory.
  Trajectory trajectory;
  std::string reason;   ///< why there is none; empty when there is
  double joins_at{};    ///< on the new trajectory's own time [s]
  double connecting{};  ///< duration of the connecting motion [s]
  /// Returns whether there is a trajectory.
  bool ok() const { return reason.empty(); }
};

/// The same outside of a cycle. `limits` as for the time scaling (time_scaling.hpp): what must hold
/// at every instant.
Switched switch_to(const MotionState3& now, const Trajectory& next, const KinematicLimits& limits,
                   const SwitchSettings& settings = {});

}  // namespace handsel
