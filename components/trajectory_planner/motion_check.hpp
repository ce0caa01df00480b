// SPDX-License-Identifier: Apache-2.0
// Checks a trajectory for contacts continuously, not only at steps. Own method.
#pragma once

#include <cstdint>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/path/segment_table.hpp"

namespace handsel::trajectory_planner {

/// Encloses parts of the trajectory in boxes of configurations; a box that the batch check clears
/// is free. Other boxes are halved until no axis moves by more than `finest`. Then FCL checks the
/// middle, whose distance from the scene must exceed every motion in the box. For this boxes are
/// halved down to `finest` / 16; a smaller distance counts as contact.
class MotionCheck {
 public:
  /// `rest`: positions of all axes, used for axes that the trajectory does not move [rad]. Sets the
  /// moving axes of the world.
  MotionCheck(const RobotModel& robot, CollisionWorld& world, const std::vector<int>& axes,
              const Vector& rest, double finest = 0.0004);

  /// Returns whether the trajectory is free of contact. `table`: of the same trajectory, in the
  /// order of the given axes.
  bool free(const Trajectory& trajectory, const SegmentTable& table);

 private:
  struct Piece {
    double begin{}, end{};
  };
  void enclose(const SegmentTable& table, const Piece& piece, Vector& low, Vector& high);
  void cut_in_two(const Piece& piece);
  enum class Leaf { free, contact, unclear };
  Leaf check(const Vector& low, const Vector& high);

  const RobotModel& robot_;
  CollisionWorld& world_;
  const std::vector<int>& axes_;
  Vector rest_;
  double finest_;
  // Max distance of moved points from each axis [m]; 1 for a prismatic axis; computed on first use.
  Vector levers_;
  MotionState3 at_begin_, at_end_;
  Vector acceleration_;  // max of each axis
  int cursor_{};
  std::vector<Piece> open_;
  std::vector<Vector> low_, high_;
};

}  // namespace handsel::trajectory_planner
