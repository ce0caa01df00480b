// Whether a robot may run a trajectory without contact, checked everywhere along it and not at
// steps only. Own method.
#pragma once

#include <cstdint>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/path/segment_table.hpp"

namespace handsel::trajectory_planner {

/// Every piece of the trajectory stays inside a box of configurations; a box that the batch check
/// clears is free whatever happens in it. Others are cut in two, down to boxes in which no axis
/// moves by more than `finest`: there FCL checks the middle, and the scene must be farther from it
/// than anything moves in the box. Boxes are cut further for that, down to `finest` / 16; what
/// comes nearer then counts as contact.
class MotionCheck {
 public:
  /// `rest`: all axes [rad]; those that the trajectory does not move are there. Sets the moving
  /// axes of the world.
  MotionCheck(const RobotModel& robot, CollisionWorld& world, const std::vector<int>& axes,
              const Vector& rest, double finest = 0.0004);

  /// Returns whether no configuration on the trajectory is in contact. `table`: of the same
  /// trajectory, in the order of the axes given.
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
  // what an axis carries is nowhere farther from it [m]; 1 for one that slides; found when first
  // needed
  Vector levers_;
  MotionState3 at_begin_, at_end_;
  Vector acceleration_;  // largest of each axis
  int cursor_{};
  std::vector<Piece> open_;
  std::vector<Vector> low_, high_;
};

}  // namespace handsel::trajectory_planner
