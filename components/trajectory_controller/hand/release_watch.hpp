// SPDX-License-Identifier: Apache-2.0
// When the hand releases its load at the handover, from the force on the hand. Own method. A
// confident pull loosens the grip, only so far that it still bears the load; a pull that continues,
// or a load that is gone because the person bears it, opens the hand; a load that comes back closes
// it again. Noise, tremor, bumps and false starts do none of this. Pure.
#pragma once

#include <cstdint>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "components/trajectory_controller/hand/pull_filter.hpp"

namespace handsel::trajectory_controller {

/// Thresholds and times of ReleaseWatch.
struct PullSettings {
  double baseline_time{0.25};    ///< averaging of the load's own force after arming [s]
  double filter_time{0.03};      ///< time constant of the force filter [s]
  double quick_time{0.005};      ///< of the filter that notices the end of a pull or bump [s]
  double hold_time{0.10};        ///< a confident pull is beyond the threshold for this long [s]
  double impulse{0.4};           ///< and has at least this force times time [N s]
  double direction_cosine{0.7};  ///< of the force with its mean direction
  double away_cosine{-0.2};      ///< a force pointing away from the person does not count
  double commit_time{0.5};       ///< a pull that has lasted for this long opens the hand [s]
  double slack_fraction{0.35};   ///< the person bears the load below this fraction of it
  double slack_time{0.15};       ///< and for this long: the hand opens [s]
  double lost_time{0.02};        ///< the load back on the hand for this long: close again [s]
  double timeout{1.0};           ///< timeout when loosened with neither: close again [s]
  /// Fraction of the threshold, or of the load if that is smaller, below which there is no pull.
  double lasts_fraction{0.5};
  double min_load{0.4};  ///< below this load nobody is taken to bear part of it [N]
};

/// What the hand is to do. Ordered: later ones are nearer to a release.
enum class Grip : std::uint8_t { hold, loosen, open };

/// One sample of what is felt.
struct Felt {
  Vector3 force{Vector3::Zero()};   ///< on hand and load without the weight of the hand, world [N]
  Vector3 toward{Vector3::Zero()};  ///< unit vector to the person, zero if unknown
  bool person_near{};               ///< a person's hand is where it can carry the load
  bool pressing{};                  ///< the fingers press on the load
};

class ReleaseWatch {
 public:
  explicit ReleaseWatch(const PullSettings& settings)
      : settings_(settings),
        filter_({settings.baseline_time, settings.filter_time, settings.quick_time,
                 settings.min_load}) {}

  /// Starts over: the load's own force is measured from the samples that follow. threshold: min
  /// pull that counts [N].
  void arm(double threshold) noexcept;
  /// Ends the watch; grip() keeps its value until arm().
  void disarm() noexcept { armed_ = false; }
  /// One sample of the load's own force while no person's hand is near, before arming. With this
  /// force, a person who holds the load already when the watch is armed is distinguished from the
  /// load.
  void bear(const Vector3& force, TimePoint now) noexcept { filter_.bear(force, now); }
  /// The hand takes hold of something else.
  void forget_load() noexcept { filter_.forget_load(); }
  /// Returns whether arm() was called last, not disarm().
  bool armed() const { return armed_; }

  /// Takes one sample and returns what the hand is to do. Unarmed, or with a force that is not
  /// finite, nothing changes.
  Grip update(const Felt& felt, TimePoint now) noexcept;
  /// Result of the last update(); hold after arm().
  Grip grip() const { return grip_; }

  /// Filtered force beyond the load's own [N].
  double pull() const { return filter_.pull(); }
  /// Fraction of the load still felt; 1: all.
  double load_ratio() const { return filter_.load_ratio(); }
  double threshold() const { return threshold_; }     ///< smallest pull that counts [N]
  std::uint64_t regrips() const { return regrips_; }  ///< times the load came back

 private:
  bool strong(const Vector3& toward, TimePoint now) noexcept;
  void close_again() noexcept;

  PullSettings settings_;
  PullFilter filter_;
  bool armed_{}, started_{}, above_{};
  Grip grip_{Grip::hold};
  double threshold_{}, impulse_{}, slack_for_{}, lost_for_{}, loose_for_{};
  std::uint64_t regrips_{};
  TimePoint first_{}, last_{}, above_since_{};
  Vector3 mean_{Vector3::Zero()};  // sum of the directions of the pull
};

}  // namespace handsel::trajectory_controller
