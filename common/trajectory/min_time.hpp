// SPDX-License-Identifier: Apache-2.0
// One axis from any state to any state (chapter sections 4.3.1 to 4.3.3). Nothing here allocates,
// locks or throws.
//
// Own derivation: it gives closed forms instead of a search. For a fixed duration T the motions
// inside the limits form a convex set, so the displacements they reach are an interval [least(T),
// largest(T)]. The motion of largest displacement is +J 0 -J 0 -J 0 +J, one parameter, T in closed
// form. largest(T) is concave, then convex until the velocity limit is met, so its first root is
// found without search. A motion of imposed duration is the mean of the least and the largest,
// weighted to meet the displacement: inside all limits because they are convex. Durations at which
// the wanted displacement is outside the interval are blocked.
#pragma once

#include <array>

#include "common/trajectory/trajectory.hpp"

namespace handsel {

struct AxisLimits {
  double velocity{}, acceleration{}, jerk{};  ///< [rad/s, rad/s^2, rad/s^3], > 0
};
/// Returns the limits of one axis; `axis` is not checked.
inline AxisLimits limits_of(const KinematicLimits& limits, Eigen::Index axis) {
  return {limits.velocity[axis], limits.acceleration[axis], limits.jerk[axis]};
}

/// Segments of one axis, without allocation.
struct AxisProfile {
  static constexpr int kCapacity = 20;  ///< largest number of segments; push() drops what is beyond
  int count{};                          ///< number of segments in use
  /// In order of time; only the first `count` are initialised.
  std::array<Segment, kCapacity> segments;

  AxisProfile() = default;
  AxisProfile(const AxisProfile& other) noexcept { *this = other; }
  AxisProfile& operator=(const AxisProfile& other) noexcept {
    count = other.count;
    for (int k = 0; k < count; ++k) segments[k] = other.segments[k];
    return *this;
  }
  /// Removes all segments.
  void clear() noexcept { count = 0; }
  /// Drops empty segments, joins equal neighbours.
  void push(double duration, double jerk) noexcept {
    if (!(duration > 0)) return;
    if (count > 0 && segments[count - 1].jerk == jerk) {
      segments[count - 1].duration += duration;
    } else if (count < kCapacity) {
      segments[count++] = {duration, jerk};
    }
  }
  /// Returns the sum of the durations of all segments [s].
  double duration() const noexcept {
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += segments[k].duration;
    return sum;
  }
};

enum class AxisOutcome {
  ok,
  not_finite,         ///< a number is NaN, infinite or too large to compute with
  bad_limits,         ///< a limit is zero or negative
  end_beyond_limits,  ///< the end state, or what must precede it, breaks a limit
  too_short,          ///< the imposed duration is below the minimum
  wrong_size,         ///< a state or the limits have another number of axes
  /// No motion inside the limits has the imposed duration, though shorter ones exist.
  blocked,
};
/// Returns the cause of a failure as part of a sentence, "" for ok.
const char* reason(AxisOutcome) noexcept;

/// State after `duration` of constant jerk.
inline AxisState advanced(const AxisState& s, double t, double jerk) noexcept {
  return {s.position + t * (s.velocity + t * (s.acceleration / 2 + t * jerk / 6)),
          s.velocity + t * (s.acceleration + t * jerk / 2), s.acceleration + t * jerk};
}

namespace detail {
/// The motions of largest displacement between two velocity-acceleration pairs, by one parameter s;
/// durations grow with s. Canonical: mirrored (x -> -x) on request, time-reversed so that C >= 0.
/// Peak acceleration min(sqrt(s^2 + C), A), valley -min(s, A).
class MotionFamily {
 public:
  MotionFamily() = default;
  MotionFamily(double v0, double a0, double vf, double af, const AxisLimits& limits,
               bool mirrored) noexcept;

  double duration(double s) const noexcept;
  double displacement(double s) const noexcept { return displacement(s, nullptr); }
  double displacement(double s, double* slope) const noexcept;
  /// Parameter and cruise for a duration of the main component; the inverse of duration().
  double parameter(double T, double* cruise) const noexcept;
  /// Displacement at a duration of the main component.
  double displacement_at(double T) const noexcept;
  double parameter_in_island(double T) const noexcept;
  /// The first root of displacement(s) = D in [from, to] with displacement(from) <= D; false if
  /// there is none.
  bool first_root(double D, double from, double to, double* s) const noexcept;
  /// The same on the main component, where a root always exists: s, and the cruise that may be
  /// needed.
  double root(double D, double from, double* cruise) const noexcept;
  /// Change of displacement per change of duration.
  double gain(double s) const noexcept;
  double cruise_velocity() const noexcept { return V_; }
  /// Whether the gap after the island is nothing but rounding.
  bool gap_is_rounding() const noexcept;
  void close_gap() noexcept;
  /// Jerks times `share`.
  void emit(double s, double cruise, AxisProfile& out, double scale = 1) const noexcept;

  bool island{};                    ///< short durations form a component of their own
  double island_lo{}, island_hi{};  ///< parameter range of that component
  /// Range of the main component; at s_hi the velocity limit is met.
  double s_lo{}, s_hi{};

 private:
  double min_gain() const noexcept;
  /// Returns the place of max displacement between a place where it grows and one where it falls.
  double top(double lo, double hi) const noexcept;
  double bracketed(double D, double lo, double hi, double f_lo) const noexcept;
  double v0_{}, a0_{}, vf_{}, af_{}, V_{}, A_{}, J_{}, over_J_{}, over_JA_{}, C_{}, at_limit_{};
  bool mirrored_{}, reversed_{};
};
}  // namespace detail

/// A prepared problem: what durations are possible, and the motion for each.
class AxisProblem {
 public:
  /// Starts outside the limits are first brought back inside as fast as possible; such a motion is
  /// outside until then.
  AxisOutcome init(const AxisState& from, const AxisState& to, const AxisLimits& limits) noexcept;

  double minimum() const noexcept { return minimum_; }  ///< [s]
  /// Returns the shortest possible duration that is not below `duration` [s]: beyond it only where
  /// `duration` is blocked.
  double earliest(double duration) const noexcept;
  /// Writes the motion of duration minimum(). Only after init() has returned ok.
  void minimum_profile(AxisProfile& out) const noexcept;
  /// A motion of exactly this duration inside the limits.
  AxisOutcome profile(double duration, AxisProfile& out) const noexcept;
  /// Returns whether the start state is outside the limits or leads there, so that every motion
  /// begins with a braking part.
  bool starts_outside() const noexcept { return brake_.count > 0; }

 private:
  struct Choice {
    double duration, s, cruise;
    bool mirrored;
  };
  /// What is possible at a duration of the main component.
  struct Span {
    double T{-1}, s_up{}, s_down{}, cruise_up{}, cruise_down{}, largest{}, smallest{};
  };
  Span span_at(double T) const noexcept;
  double slack(const Span& at) const noexcept;
  Choice first_from(double duration) const noexcept;
  void settle_islands() noexcept;
  bool arrives(const AxisProfile&, double duration) const noexcept;
  AxisOutcome profile_in(const Span& span, AxisProfile& out) const noexcept;

  AxisProfile brake_;
  double brake_time_{};
  detail::MotionFamily up_, down_;
  double distance_{}, scale_{}, speed_{}, over_J_{}, minimum_{};
  double main_{};  ///< the main component of durations begins here
  AxisState start_, end_;
  AxisLimits limits_;
  bool still_{}, rest_{}, alike_{};
  Choice best_{};
};

/// Minimum time between two states. `out` is untouched unless ok.
AxisOutcome solve_axis(const AxisState& from, const AxisState& to, const AxisLimits& limits,
                       AxisProfile& out) noexcept;

/// Minimum time of a rest-to-rest motion over a distance, in closed form (chapter section 4.3.1)
/// [s].
double rest_to_rest_time(double distance, const AxisLimits& limits) noexcept;

}  // namespace handsel
