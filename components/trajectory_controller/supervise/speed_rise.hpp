// SPDX-License-Identifier: Apache-2.0
// How fast a path may gather speed again after people have slowed it. Own method: what people
// allow depends on the arm's acceleration as well, so a path that gathered speed as fast as the
// axes can would be slowed again by that alone, over and over. Pure, no heap.
#pragma once

namespace handsel::trajectory_controller {

/// How the speed factor rises.
struct SpeedRiseSettings {
  double period{0.001};        ///< of control [s]
  double rate{2.0};            ///< largest rate of the speed factor allowed [1/s]
  double unproven_ratio{0.8};  ///< after a set-point without a checked stop: of the factor in force
  double unproven_rate{0.2};   ///< largest rate after that [1/s]
};

/// A limit of the speed factor and its causes.
struct SpeedLimit {
  double factor{1.0};     ///< largest speed factor allowed, [0, 1]
  bool people{}, wall{};  ///< what limits the factor
};

class SpeedRise {
 public:
  explicit SpeedRise(const SpeedRiseSettings& settings) : settings_(settings) {}

  /// Forgets what was allowed: a path begins at rest.
  void restart() noexcept { allowed_ = ceiling_ = 1.0; }
  /// Forgets what was allowed, except after set-points without a checked stop: the arm is at rest.
  void rest() noexcept { allowed_ = 1.0; }
  /// Nothing is allowed in the next cycle.
  void forbid() noexcept { allowed_ = 0.0; }
  /// Lowers what is allowed: at the speed factor `factor` a set-point had no checked stop.
  void lower(double factor) noexcept;
  /// Notes a limit before the first cycle of a path.
  void note(double limit) noexcept;
  /// Returns the limit in the next cycle, at most `limit`; while the speed factor rises, the causes
  /// are also those that lowered the factor.
  SpeedLimit next(const SpeedLimit& limit) noexcept;

 private:
  SpeedRiseSettings settings_;
  double allowed_{1.0};           // in the last cycle
  bool by_people_{}, by_wall_{};  // what lowered allowed_
  double ceiling_{1.0};           // after set-points without a checked stop
};

}  // namespace handsel::trajectory_controller
