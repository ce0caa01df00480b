// SPDX-License-Identifier: Apache-2.0
// Checks whether all people are so far that none can reach the robot within a stop, from distances
// measured once for each sample of people. Pure, no heap after construction, noexcept.
#pragma once

#include <cstdint>
#include <vector>

#include "components/trajectory_controller/supervise/stop/moving_chain.hpp"
#include "components/trajectory_controller/supervise/stop/stop_bounds.hpp"

namespace handsel::trajectory_controller {

/// Travel of each capsule up to the first possible contact with a person, measured at one moment.
class FreeSpace {
 public:
  /// Keeps a reference to the chain. `dof`: number of axes of the robot.
  FreeSpace(const MovingChain& chain, int dof);

  /// Begins a measurement: for people of a revision, the robot at `position`, within `duration`
  /// [s]; no person is faster than `max_person_speed` [m/s].
  void begin(std::uint64_t revision, const Pose& T_world_base, const Vector& position,
             double duration) noexcept;
  /// Sets the max speed of the people [m/s].
  void set_max_person_speed(double speed) noexcept { max_person_speed_ = speed; }
  /// Notes the free space of a capsule [m].
  void set(std::size_t capsule, double distance) noexcept { space_[capsule] = distance; }
  /// Returns whether the measurement is of these people and of a base at this place.
  bool is_of(std::uint64_t revision, const Pose& T_world_base) const noexcept;
  /// Returns whether every capsule that may be faster than `min_speed` [m/s] is still so far from
  /// all people that none reaches it: the measured free space minus its travel since.
  bool suffices(const StopBounds& bounds, const Vector& position, double duration,
                double min_speed) noexcept;

 private:
  const MovingChain& chain_;
  std::vector<double> space_;  // by capsule [m]
  std::vector<double> moved_;  // by axis, since the measurement
  std::uint64_t revision_{};
  Pose T_world_base_{Pose::Identity()};
  Vector position_;
  double duration_{};
  double max_person_speed_{};
};

}  // namespace handsel::trajectory_controller
