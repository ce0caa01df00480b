// SPDX-License-Identifier: Apache-2.0
// The adaptive clock of a behaviour, whose period falls with urgency (formulas: section 4). Own
// method: the chapter has no section on attention.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/time.hpp"

namespace handsel::attention {

/// The law that determines the next period from the stimulus.
enum class ClockLaw {
  linear,  ///< p = p_max * (0.1 + 0.9 * (s - near) / (far - near))
  weber,   ///< the period changes in proportion to the relative change of the stimulus
  fixed,   ///< constant `period`
  margin,  ///< evaluates before a person can cross the margin
};

/// Parameters of the law `margin`: p = use * (d - distance) / (person_speed + robot_speed), less
/// the age of the data, where d is the distance to the nearest person. Own method.
struct MarginSettings {
  double use{0.8};           ///< fraction of the margin that may be crossed in one period, (0, 1)
  double distance{0.6};      ///< distance at which the margin is 0 [m], >= 0
  double person_speed{1.6};  ///< max speed of people [m/s], > 0
  double robot_speed{0.4};   ///< max speed of the robot toward people [m/s], >= 0
  double data_age{0.1};      ///< max age of an observation when it is evaluated [s], >= 0
};

/// Range and law of the period of one behaviour.
struct ClockSettings {
  ClockLaw rule{ClockLaw::linear};  ///< law of the next period
  double p_min{0.033};              ///< min period [s], > 0, at least that of the source
  double p_max{0.3};                ///< max period [s], >= p_min
  double near{0.1};                 ///< stimulus at which the period is a tenth of p_max
  double far{1.2};                  ///< stimulus from which the period is p_max, > near
  double weber_gain{1.0};           ///< relative change of the period per that of the stimulus, > 0
  double period{};                  ///< period of the fixed law, [p_min, p_max] [s]
  MarginSettings margin{};          ///< parameters of the law margin
};

/// Returns the unclamped period of the law margin [s]: until the next evaluation, at most `delay`
/// late [s], people cross at most the fraction `use` of the margin. `distance`: to the nearest
/// person [m]; +inf: none.
double margin_period(double distance, double delay, const MarginSettings& margin);

/// Computes p_t = rho * clamp(f(s_t, p_t-1)) + (1 - rho) * p_t-1 with rho = 1 when the clock fires.
class AdaptiveClock {
 public:
  /// `slack`: half the caller's tick, so that periods are rounded to ticks, not up. Throws
  /// ConfigError that names `what`.
  AdaptiveClock(const ClockSettings& settings, Duration slack, const std::string& what);

  /// Returns whether the behaviour must observe now: before the first fire(), and from half a tick
  /// before the end of the period.
  bool due(TimePoint now) const { return !started_ || now + slack_ >= next_; }
  /// Notes an observation and computes the next period. `stimulus` >= 0 falls with urgency; for the
  /// law margin it is the distance to the nearest person [m].
  void fire(double stimulus, TimePoint now);

  double period() const { return period_; }  ///< current period [s]; p_min before the first fire()
  /// Returns the number of calls of fire().
  std::uint64_t activations() const { return activations_; }
  /// Returns the number of calls of fire() until now for a constant period p_min.
  std::uint64_t activations_at_fastest(TimePoint now) const;

 private:
  ClockSettings settings_;
  Duration slack_;
  double period_;
  double previous_{};
  bool started_{};
  TimePoint first_{}, next_{};
  std::uint64_t activations_{};
};

}  // namespace handsel::attention
