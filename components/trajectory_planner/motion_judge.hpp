// Whether a robot may run a trajectory without contact, judged everywhere along it and not at steps only. Ours.
#pragma once

#include <cstdint>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/trajectory/segment_table.hpp"

namespace handsel::trajectory_planner {

/// Every piece of the trajectory stays inside a box of configurations; a box that the wide check clears is free whatever happens in it.
/// Others are cut in two, down to boxes in which no axis moves by more than `finest`: there FCL judges the middle.
class MotionJudge {
 public:
  /// `rest`: all axes [rad]; those that the trajectory does not move are there. Sets the moving axes of the world.
  MotionJudge(CollisionWorld& world, const std::vector<int>& axes, const Vector& rest, double finest = 0.0004);

  /// `table`: of the same trajectory, in the order of the axes given.
  bool free(const Trajectory& trajectory, const SegmentTable& table);

 private:
  struct Piece {
    double begin{}, end{};
  };
  void enclose(const SegmentTable& table, const Piece& piece, Vector& low, Vector& high);

  CollisionWorld& world_;
  const std::vector<int>& axes_;
  Vector rest_;
  double finest_;
  MotionState3 at_begin_, at_end_;
  Vector acceleration_;  // largest of each axis
  int cursor_{};
  std::vector<Piece> open_;
  std::vector<Vector> low_, high_;
};

}  // namespace handsel::trajectory_planner
