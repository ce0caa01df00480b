// The time law of a running trajectory: d(tau)/dt = alpha, alpha in [-1, 1] (chapter section 2; the bounds are ours).
//
// alpha'' is chosen every step. Before a choice is taken, the way back to a constant alpha is run ahead on the trajectory itself and must
// keep every limit; a constant alpha always does, so there is always a way out, whatever is asked for and when. The choice that
// gets toward the target fastest is taken; so slowing is as fast as the path permits at that place.
#pragma once

#include <string>
#include <vector>

#include "common/trajectory/segment_table.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

class TimeLaw {
 public:
  TimeLaw() = default;
  /// The trajectory must keep `guard` (it is planned at guard / 1.1: the rest is what alpha can be changed with) and end at rest.
  /// One that starts moving begins with alpha = 1 and is never run backwards. Returns why not, or nothing. Allocates; nothing else does.
  /// `step`: how often alpha'' is chosen [s]; best the control period. `alpha`: in force at first.
  std::string init(const Trajectory&, const KinematicLimits& guard, double step = 0.001, double alpha = 1.0);

  /// [-1, 1], clamped; anything not finite means 0.
  void set_target(double alpha) noexcept;
  double target() const noexcept { return target_; }
  void advance(double dt) noexcept;

  const MotionState3& state() const noexcept { return state_; }  ///< of all axes now
  const Eigen::VectorXd& jerk() const noexcept { return jerk_; }
  double time() const noexcept { return now_.tau; }  ///< along the trajectory [s]
  double alpha() const noexcept { return now_.alpha; }
  double alpha_rate() const noexcept { return now_.beta; }  ///< [1/s]
  double duration() const noexcept { return table_.duration(); }
  bool finished() const noexcept { return now_.tau >= duration(); }  ///< at the end, at rest
  bool back_at_start() const noexcept { return now_.tau <= 0 && now_.alpha < 0; }
  bool standing() const noexcept { return now_.alpha == 0 && now_.beta == 0; }

 private:
  struct Now {
    double tau{}, alpha{}, beta{};
  };
  struct Rates {
    int segment{};
    std::vector<double> v, a, j;
  };
  void rates_at(double tau, Rates&) const noexcept;
  bool bounds(const Now&, const Rates& begin, const Rates& end, double* lo, double* hi) noexcept;
  bool recover(Now s, double* first, double* alpha_end) noexcept;
  Now next_of(const Now& s, double u) const noexcept;
  double choose() noexcept;
  static Now moved(const Now& s, double u, double t) noexcept;
  void publish() noexcept;

  SegmentTable table_;
  std::vector<int> moving_;
  std::vector<double> A_, J_;
  double step_{0.001}, lowest_{-1}, target_{1}, push_{}, phase_{};
  Now now_, tick_;
  Rates begin_, end_, between_, here_;
  MotionState3 state_;
  Eigen::VectorXd jerk_;
  int cursor_{};
};

}  // namespace handsel
