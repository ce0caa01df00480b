// SPDX-License-Identifier: Apache-2.0
// The time scaling of a running trajectory: d(tau)/dt = alpha, alpha in [-1, 1] (chapter section
// 2). Own method: the bounds of alpha'', so that every limit holds at every instant.
//
// alpha'' is chosen every step. Before a choice is taken, the return to a constant alpha is
// simulated on the trajectory itself and must keep every limit; a constant alpha always does, so a
// safe choice always exists, whatever is asked for and when. The choice that gets toward the target
// fastest is taken; so slowing is as fast as the path permits at that place.
//
// A switch to another trajectory is made in the path's own time: path so far, connecting motion
// (switch.hpp), rest of the new trajectory, twice continuously differentiable; so velocity and
// acceleration are continuous at any alpha, and running back leads over the old path.
#pragma once

#include <string>
#include <vector>

#include "common/trajectory/path/segment_table.hpp"
#include "common/trajectory/switch.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

/// Returns an empty text when the time scaling can run the trajectory: it keeps `guard`, has axes
/// and ends at rest; else one sentence.
std::string why_not_runnable(const Trajectory&, const KinematicLimits& guard);

class TimeScaling {
 public:
  TimeScaling() = default;
  /// The trajectory must keep `guard` (it is planned at guard / 1.1: the rest is what alpha can be
  /// changed with) and end at rest. One that starts moving begins with alpha = 1 and is never run
  /// backwards. Returns why not, or nothing. Allocates; nothing else does as long as what a switch
  /// makes stays below kRoom segments (all axes split alike). `step`: how often alpha'' is chosen
  /// [s]; best the control period. `alpha`: in force at first.
  std::string init(const Trajectory&, const KinematicLimits& guard, double step = 0.001,
                   double alpha = 1.0);

  /// Switches to another trajectory from where the path is now; alpha is kept. At rest it starts
  /// from rest; while running back the motion continues in its direction, and never runs back
  /// beyond here. The path so far is forgotten only when there is no room for it. `next` is
  /// runnable and laid out beforehand. On anything but ok nothing has changed.
  SwitchOutcome switch_to(const SegmentTable& next, const SwitchSettings& = {}) noexcept;
  /// The same, but the switch point is `leave` on its time() [s]; the path beyond is given up. A
  /// time already passed counts as now.
  SwitchOutcome switch_at(double leave, const SegmentTable& next,
                          const SwitchSettings& = {}) noexcept;
  /// Takes the last switch back, as if it had not been; before the next advance() only.
  void undo_switch() noexcept;
  /// Starts on a trajectory from any state of the axes, moving or not, whatever ran before; alpha
  /// is 1, and it never runs back beyond here.
  SwitchOutcome start_from(const MotionState3& state, const SegmentTable& next,
                           const SwitchSettings& = {}) noexcept;

  /// Sets alpha and the target at once, clamped to [0, 1], where the path itself is at rest (as at
  /// its beginning). Returns false, and changes nothing, elsewhere.
  bool begin_with(double alpha) noexcept;

  /// Sets the alpha aimed at, clamped to [-1, 1], or to [0, 1] where the path must not run back; 0
  /// when not finite.
  void set_target(double alpha) noexcept;
  /// Returns the alpha aimed at, after clamping.
  double target() const noexcept { return target_; }
  /// Advances by `dt` [s], in steps as given to init(); nothing happens for dt <= 0.
  void advance(double dt) noexcept;

  const MotionState3& state() const noexcept { return state_; }  ///< of all axes now
  /// Returns the jerk of all axes now [rad/s^3]; 0 before the beginning and after the end of the
  /// path.
  const Eigen::VectorXd& jerk() const noexcept { return jerk_; }
  double time() const noexcept { return now_.tau; }  ///< along path() [s]
  /// On the own time of the trajectory given last; while the connecting motion of a switch runs:
  /// before joined_at() [s].
  double own_time() const noexcept { return now_.tau - offset_; }
  /// Own time at which the trajectory given last was joined [s].
  double joined_at() const noexcept { return joined_at_; }
  /// Switch point of the last switch on time() [s].
  double switched_at() const noexcept { return switched_at_; }
  /// What is run: trajectories given and connecting motions.
  const SegmentTable& path() const noexcept { return table_; }
  /// Returns d(tau)/dt now, in [-1, 1].
  double alpha() const noexcept { return now_.alpha; }
  double alpha_rate() const noexcept { return now_.beta; }  ///< [1/s]
  /// Returns the duration of path() at alpha 1 [s].
  double duration() const noexcept { return table_.duration(); }
  bool finished() const noexcept { return now_.tau >= duration(); }  ///< at the end, at rest
  /// Returns whether the motion has run back to the beginning of path(), with alpha still negative.
  bool back_at_start() const noexcept { return now_.tau <= 0 && now_.alpha < 0; }
  /// Returns whether alpha and its rate are 0, so that every axis is at rest.
  bool standing() const noexcept { return now_.alpha == 0 && now_.beta == 0; }

 private:
  struct Now {
    double tau{}, alpha{}, beta{};
  };
  /// Velocities, accelerations and jerks of the path at one of its times.
  struct Rates {
    int segment{};
    std::vector<detail::BatchRow> values;
    double* data() noexcept { return values.data()->value; }
    const double* data() const noexcept { return values.data()->value; }
  };
  void rates_at(double tau, Rates&) const noexcept;
  detail::ScalingStep step_from(const Now&) const noexcept;
  bool pushes(const Now&, const Rates& begin, const Rates& end, double* range) noexcept;
  bool holds(const Now& s, const Now& next, double push) const noexcept;
  /// A return to a constant alpha: what to choose step by step, and the alpha it ends with.
  struct Recovery {
    std::vector<double> pushes;
    int next{}, count{};
    double end{};
    double take() noexcept { return next < count ? pushes[static_cast<std::size_t>(next++)] : 0.0; }
    void stay(double alpha) noexcept { next = count = 0, end = alpha; }
  };
  bool recover(Now s, Recovery& out) noexcept;
  Now next_of(const Now& s, double u) const noexcept;
  SwitchOutcome take_over(const MotionState3& from, const Now& at, double keep_from, double leave,
                          const SegmentTable& next, const SwitchSettings& settings) noexcept;
  void back_to_before() noexcept;
  double choose() noexcept;
  void publish() noexcept;

  static constexpr int kRoom = 2000;
  SegmentTable table_, spare_;
  TrajectorySwitch connection_;
  KinematicLimits guard_;
  MotionState3 from_, row_;
  double offset_{}, joined_at_{}, switched_at_{};
  struct Before {
    Now now;
    double lowest{}, target{}, offset{}, joined_at{}, switched_at{};
  } before_;  // the last switch
  std::vector<detail::BatchRow>
      limits_;  // of acceleration, then of jerk; as table_ lays out its axes
  double step_{0.001}, lowest_{-1}, target_{1}, push_{}, phase_{};
  Now now_, tick_;
  Recovery recovery_, tried_, best_;  // from now; of the choice tried; of the best choice so far
  Rates begin_, end_, between_;
  MotionState3 state_;
  Eigen::VectorXd jerk_;
  int cursor_{};
};

}  // namespace handsel
