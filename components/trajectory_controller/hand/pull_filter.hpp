// SPDX-License-Identifier: Apache-2.0
// The pull on a hand: the force beyond the load's own, filtered. Pure, no heap.
#pragma once

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel::trajectory_controller {

/// Time constants and limits of PullFilter.
struct PullFilterSettings {
  double baseline_time{0.25};  ///< averaging of the load's own force [s]
  double filter_time{0.03};    ///< time constant of the force filter [s]
  double quick_time{0.005};    ///< of the filter that notices the end of a pull or bump [s]
  double min_load{0.4};        ///< below this load the ratio of what is still felt says nothing [N]
};

class PullFilter {
 public:
  explicit PullFilter(const PullFilterSettings& settings) : settings_(settings) {}

  /// Takes a sample of the load's own force while no person's hand is near.
  void bear(const Vector3& force, TimePoint now) noexcept;
  /// Forgets the load: the hand takes hold of something else.
  void forget_load() noexcept { load_known_ = false; }

  /// Starts over: the load's own force is measured from the samples that follow.
  void reset() noexcept;
  /// Adds a sample to the average of the load's own force.
  void average(const Vector3& force) noexcept;
  /// Returns whether there is an average.
  bool averaged() const noexcept { return samples_ > 0; }
  /// Decides, once, whether a person held the load already while its force was averaged: then the
  /// force that was felt before counts. `threshold`: of a pull [N].
  void check_baseline(bool person_near, double threshold) noexcept;
  /// Filters a sample, `dt` [s] after the one before.
  void update(const Vector3& force, double dt) noexcept;

  /// Filtered force beyond the load's own [N].
  double pull() const noexcept { return pull_; }
  /// Fraction of the load still felt; 1: all.
  double load_ratio() const noexcept { return load_ratio_; }
  /// The load's own force [N].
  double load() const noexcept { return baseline_.norm(); }
  /// Force beyond the load's own, filtered, world [N].
  const Vector3& filtered() const noexcept { return filtered_; }
  /// The same with less delay.
  const Vector3& quick() const noexcept { return quick_; }

 private:
  PullFilterSettings settings_;
  Vector3 load_{Vector3::Zero()};  // averaged while no person's hand was near
  TimePoint load_felt_{};
  bool load_known_{}, baseline_checked_{};
  int samples_{};
  double pull_{}, load_ratio_{1.0};
  Vector3 baseline_{Vector3::Zero()}, filtered_{Vector3::Zero()}, quick_{Vector3::Zero()};
};

}  // namespace handsel::trajectory_controller
