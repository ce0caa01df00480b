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
};

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
  /// urgency and is >= 0.
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
