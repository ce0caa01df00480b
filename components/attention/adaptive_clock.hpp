// The clock of a behaviour: it fires more often where it matters (formulas: section 4). Own method:
// the chapter's section on attention is missing.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/time.hpp"

namespace handsel::attention {

/// How the next period follows from the stimulus.
enum class ClockLaw {
  linear,  ///< p = p_max * (0.1 + 0.9 * (s - near) / (far - near))
  weber,   ///< the period changes in proportion to the relative change of the stimulus
  fixed,   ///< `period`, whatever happens
  margin,  ///< the next evaluation before the margin to a person can be used up
};

/// What the law `margin` assumes: p = use * (d - distance) / (person_speed + robot_speed), less the
/// age of the data, where d is the distance to the nearest person. Own method.
struct MarginSettings {
  double use{0.8};           ///< fraction of the margin that may be used up, (0, 1)
  double distance{0.6};      ///< at which the margin is used up [m], >= 0
  double person_speed{1.6};  ///< max speed of people [m/s], > 0
  double robot_speed{0.4};   ///< max speed of the robot toward people [m/s], >= 0
  double data_age{0.1};      ///< max age of an observation when it is evaluated [s], >= 0
};

/// Range and rule of the period of one behaviour.
struct ClockSettings {
  ClockLaw rule{ClockLaw::linear};  ///< rule that gives the next period
  double p_min{0.033};              ///< shortest period [s], > 0, at least that of the source
  double p_max{0.3};                ///< longest period [s], >= p_min
  double near{0.1};                 ///< stimulus at which the period is a tenth of p_max
  double far{1.2};                  ///< stimulus from which the period is p_max, > near
  double weber_gain{1.0};           ///< relative change of the period per that of the stimulus, > 0
  double period{};                  ///< of the fixed law, [p_min, p_max] [s]
  MarginSettings margin{};          ///< of the law margin
};

/// Returns the period of the law margin before it is clamped [s]: at most `use` of what is left of
/// the distance to a person can be used up until the next evaluation, which comes at most `delay`
/// late [s]. `distance`: to the nearest person [m]; +inf: nobody is there.
double margin_period(double distance, double delay, const MarginSettings& margin);

/// p_t = rho * clamp(f(s_t, p_t-1)) + (1 - rho) * p_t-1 with rho = 1 when the clock fires.
class AdaptiveClock {
 public:
  /// `slack`: half the tick of whoever asks, so that a period is rounded to ticks, not up. Throws
  /// ConfigError naming `what`.
  AdaptiveClock(const ClockSettings& settings, Duration slack, const std::string& what);

  /// Returns whether the behaviour has to observe now: before the first fire(), and from half a
  /// tick before the period is over.
  bool due(TimePoint now) const { return !started_ || now + slack_ >= next_; }
  /// Notes that the behaviour has observed and computes the next period: `stimulus` shrinks with
  /// urgency and is >= 0; for the law margin it is the distance to the nearest person [m].
  void fire(double stimulus, TimePoint now);

  double period() const { return period_; }  ///< current period [s]; p_min before the first fire()
  /// Number of calls of fire().
  std::uint64_t activations() const { return activations_; }
  /// How often it would have fired by now at p_min.
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
