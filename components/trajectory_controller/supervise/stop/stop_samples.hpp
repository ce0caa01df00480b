// SPDX-License-Identifier: Apache-2.0
// Links of the robot at several times of a stop, with their speeds. Pure, no heap after
// construction, noexcept.
#pragma once

#include <array>
#include <vector>

#include "components/trajectory_controller/supervise/stop/moving_chain.hpp"
#include "components/trajectory_controller/supervise/stop/stop_plan.hpp"

namespace handsel::trajectory_controller {

/// A link's capsule at one time, with its largest speeds.
struct CapsuleSample {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of its axis, world [m]
  double carried{};                                ///< surface speed, fingers at rest [m/s]
  double inner{};                                  ///< finger speed in the hand [m/s]
};

/// Returns where a capsule is, without speeds. `motions`: of the frames of its chain.
CapsuleSample placed(const ChainCapsule& capsule, const std::vector<FrameMotion>& motions,
                     const Pose& T_world_base) noexcept;

class StopSamples {
 public:
  static constexpr int kIntervals = 6;  ///< between the samples of a stop

  /// Keeps a reference to the chain. `dof`: number of axes of the robot.
  StopSamples(const MovingChain& chain, int dof);

  /// Forgets which capsules are needed.
  void clear() noexcept;
  /// Notes that a capsule of the chain is needed.
  void need(std::size_t capsule) noexcept;
  /// Samples the needed capsules from now until all of them are at rest; axes that carry none of
  /// them, as those of the head, may take longer. `position`: of all axes now. Returns false when
  /// none moves.
  bool take(const StopPlan& stop, const Vector& position, const Pose& T_world_base) noexcept;

  /// Time between two samples [s].
  double interval() const noexcept { return interval_; }
  /// A needed capsule at the beginning of an interval; slot kIntervals: at rest.
  const CapsuleSample& at(int slot, std::size_t capsule) const noexcept {
    return samples_[static_cast<std::size_t>(slot)][capsule];
  }
  /// Returns the largest speed of every axis in an interval of the stop that was sampled last.
  const std::vector<double>& speeds(const StopPlan& stop, int slot) noexcept;

 private:
  double time_until_rest(const StopPlan& stop) noexcept;
  void sample(const StopPlan& stop, int slot, const Pose& T_world_base) noexcept;

  const MovingChain& chain_;
  std::vector<char> needed_;         // capsules
  std::vector<char> needed_frames_;  // those that carry a needed capsule
  double interval_{};
  std::array<std::vector<CapsuleSample>, kIntervals + 1> samples_;  // of every capsule
  std::array<std::vector<double>, kIntervals> speeds_;              // of each axis
  std::array<bool, kIntervals> speeds_known_{};
  Vector position_, velocity_;
  std::vector<FrameMotion> motions_;  // of each frame
  std::vector<double> speed_, rest_;  // by axis: at the sample; when it is at rest
};

}  // namespace handsel::trajectory_controller
