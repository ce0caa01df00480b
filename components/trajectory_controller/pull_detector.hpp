// Tells a person's confident pull from noise, tremor and bumps, and a pull that goes on from one that ends (ours). Pure.
#pragma once

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel::trajectory_controller {

struct PullSettings {
  double baseline_time{0.25};    ///< the load's own force is averaged for this long after arming [s]
  double filter_time{0.03};      ///< time constant of the force filter [s]
  double quick_time{0.005};      ///< of the filter that notices the end of a pull or bump [s]
  double hold_time{0.10};        ///< beyond the threshold for this long [s]
  double direction_cosine{0.7};  ///< of the force with its mean direction since the threshold was passed
  double away_cosine{-0.2};      ///< a force pointing away from the person by more does not count
};

class PullDetector {
 public:
  explicit PullDetector(const PullSettings& settings) : settings_(settings) {}

  /// Starts over: the baseline is measured from the samples that follow. threshold [N].
  void arm(double threshold) noexcept;
  void disarm() noexcept { armed_ = false; }
  bool armed() const { return armed_; }

  /// One force sample [N], world axes. `toward`: unit vector to the person, zero if unknown. True once the pull is confident.
  bool update(const Vector3& force, const Vector3& toward, TimePoint now) noexcept;

  /// After update() said so: the pull is gone again, the load hangs on the robot as before (force back near the baseline).
  bool lost() const noexcept;

  double pull() const { return pull_; }            ///< filtered force beyond the baseline [N]
  double threshold() const { return threshold_; }  ///< [N]

 private:
  PullSettings settings_;
  bool armed_{}, started_{}, above_{};
  double threshold_{}, pull_{};
  int baseline_samples_{};
  TimePoint first_{}, last_{}, above_since_{};
  Vector3 baseline_{Vector3::Zero()}, filtered_{Vector3::Zero()}, quick_{Vector3::Zero()}, mean_{Vector3::Zero()};
};

}  // namespace handsel::trajectory_controller
