// SPDX-License-Identifier: Apache-2.0
// The joints of a robot that move, for the SIMD kernels: what the others join is one rigid body.
#pragma once

#include <vector>

#include "common/collision/simd_kernel.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

struct BatchChain {
  /// Positions beyond this are not taken by the kernels [rad].
  static constexpr double kMaxTurn = 45.0;

  std::vector<int> dof_of_row, row_of_dof;  ///< rows of the positions; -1: does not move
  std::vector<detail::SimdJoint> joints;    ///< of body i + 1; body 0 is the root
  std::vector<Pose> T_parent_joint;         ///< a joint, in its parent's body
  std::vector<double> slide;                ///< max distance a joint slides; 0 if it turns [m]
  std::vector<int> body_of_link;            ///< 0: rigid with the root
  std::vector<Pose> T_body_link;            ///< of each link in its body

  /// Fills all fields for states in which only `axes` differ from q.
  void fold(const RobotModel& robot, const std::vector<int>& axes, const Vector& q);
};

/// Writes a transform by rows of three rotations and a translation, as the kernels take it.
void put_rows(const Pose& T, float out[12]);

}  // namespace handsel
