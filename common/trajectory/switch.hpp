// From a state in motion onto another trajectory (chapter sections 2 and 4.3: trajectories modified on-line; the search is ours).
//
// A motion of least time, all axes ending together, leads from the present state to a state of the other trajectory; of the places where it
// can be joined the one is taken from which its end is reached first. Velocity and acceleration are continuous, the limits hold exactly.
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
  nowhere,              ///< nowhere in the window can the new trajectory be joined inside the limits
  too_long,             ///< more segments than there is room for
  not_now,              ///< the speed factor is changing too fast for it; a later step may do
};
const char* reason(SwitchOutcome) noexcept;

struct SwitchSettings {
  double first{0.0};                                     ///< the new trajectory is joined at or after this, on its own time [s]
  double last{std::numeric_limits<double>::infinity()};  ///< and not after this [s]
  bool on_clock{};      ///< the new trajectory runs already, its time is 0 now: it is met where it then is, as early as possible. After
                        ///< its end it stands there. `last` is not used.
  double reserve{1.1};  ///< the connecting motion keeps the limits / reserve; up to the limits where the start needs it
  int tries{24};        ///< places looked at before the best is refined
};

/// But for rounding: nothing need lead from one to the other. (The fastest way between states in motion that differ by a little is as
/// likely as not a loop of a second.)
bool same_motion(const MotionState3&, const MotionState3&) noexcept;

/// For a cycle: allocates at construction only.
class TrajectorySwitch {
 public:
  TrajectorySwitch() : TrajectorySwitch(0) {}
  explicit TrajectorySwitch(int axes);

  SwitchOutcome plan(const MotionState3& now, const SegmentTable& next, const KinematicLimits& limits, const SwitchSettings&) noexcept;

  double joins_at() const noexcept { return join_; }     ///< on the new trajectory's own time; beyond its end only on the clock [s]
  double duration() const noexcept { return connect_; }  ///< of the connecting motion [s]
  int segments() const noexcept;                         ///< at most, of the connecting motion
  /// Adds the connecting motion, then the rest of `next`, which must be what was planned for.
  void add_to(SegmentTable& out, const SegmentTable& next) noexcept;

 private:
  double meeting(const MotionState3& now, const SegmentTable& next, const KinematicLimits& limits, double t, double least) noexcept;
  bool best_place(const MotionState3& now, const SegmentTable& next, const KinematicLimits& limits, const SwitchSettings&) noexcept;
  bool earliest_meeting(const MotionState3& now, const SegmentTable& next, const KinematicLimits& limits, const SwitchSettings&) noexcept;
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

/// solve_axis for a start that is already on a time-optimal way to an end in motion, as when a motion is planned anew each tick. Such a way
/// is often the only one for its duration, and rounding decides whether it is found; so limits wider by 1e-9, then 1e-7, are tried too, and
/// taken where the motion is then shorter by more than that could make it.
AxisOutcome replan_axis(const AxisState& from, const AxisState& to, const AxisLimits& limits, AxisProfile& out) noexcept;

/// The rows of `from` in [begin, its end], or up to `end`, added to `out`. No allocation within the room of `out`.
void add_part(const SegmentTable& from, double begin, double end, SegmentTable& out, MotionState3& state) noexcept;

struct Switched {
  Trajectory trajectory;  ///< from the present state: the connecting motion, then the rest of the new trajectory
  std::string reason;     ///< why there is none; empty when there is
  double joins_at{};      ///< on the new trajectory's own time [s]
  double connecting{};    ///< [s]
  bool ok() const { return reason.empty(); }
};

/// The same outside of a cycle. `limits` as for the time law: what must hold at every instant.
Switched switch_to(const MotionState3& now, const Trajectory& next, const KinematicLimits& limits, const SwitchSettings& settings = {});

}  // namespace handsel
