// SPDX-License-Identifier: Apache-2.0
// Movers of some axes of the robot, within the limits of the robot. Pure, no heap after
// construction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/model/robot_model.hpp"
#include "components/trajectory_controller/arm/axis_mover.hpp"

namespace handsel::trajectory_controller {

class AxisMovers {
 public:
  /// Keeps a reference to the robot. `axes`: those that are moved.
  AxisMovers(const RobotModel& robot, std::vector<int> axes);

  /// Axes that are moved, first those given at construction.
  const std::vector<int>& axes() const noexcept { return axes_; }
  /// Returns of each axis of the robot whether it is moved.
  const std::vector<char>& moved() const noexcept { return moved_; }
  /// Moves these axes of the robot too, beside those given at construction. May allocate.
  void set_further_axes(const std::vector<std::uint32_t>& axes);
  /// Moves no axes but those given at construction.
  void drop_further_axes() noexcept;
  /// Mover of an axis; `axis` is not checked.
  const AxisMover& operator[](int axis) const noexcept {
    return movers_[static_cast<std::size_t>(axis)];
  }

  /// Puts all axes at rest at `position`, all axes of the robot [rad, m].
  void reset(const Vector& position) noexcept;
  /// Puts one axis at rest [rad, m].
  void reset(int axis, double position) noexcept { at(axis).reset(position); }
  /// Every axis stops from a set-point as fast as it can.
  void stop_from(const MotionState3& set_point) noexcept;
  /// One axis stops as fast as it can.
  void stop(int axis) noexcept;
  /// Moves one axis to rest at `target` within the comfort limits [rad, m].
  void go_to(int axis, double target) noexcept;
  /// Moves one axis to rest at `target` [rad, m] within `limits`.
  void go_to(int axis, double target, const AxisLimits& limits) noexcept;
  /// Advances one axis by `dt` [s] and writes it into a set-point; false: it still moves.
  bool step(int axis, double dt, MotionState3& set_point) noexcept;
  /// Advances all axes.
  void step(double dt, MotionState3& set_point) noexcept;

 private:
  AxisMover& at(int axis) noexcept { return movers_[static_cast<std::size_t>(axis)]; }

  const RobotModel& robot_;
  std::vector<int> axes_;
  std::size_t own_;                // number of axes given at construction, the first ones
  std::vector<char> moved_;        // of each axis of the robot
  std::vector<AxisMover> movers_;  // one an axis of the robot; those of other axes are unused
};

}  // namespace handsel::trajectory_controller
