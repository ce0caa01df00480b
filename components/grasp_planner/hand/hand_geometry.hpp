// SPDX-License-Identifier: Apache-2.0
// What grasping needs to know of a hand, whatever the object: chains and solids; its workspaces
// apart, because they take a moment to make.
#pragma once

#include <vector>

#include "common/grasp/grip_force.hpp"
#include "components/grasp_planner/hand/finger_chain.hpp"
#include "components/grasp_planner/hand/finger_workspace.hpp"
#include "components/grasp_planner/hand/hand_shape.hpp"

namespace handsel::grasp_planner {

struct HandGeometry {
  explicit HandGeometry(const HandModel& hand_model);

  /// Computes the poses of the moving joints of every finger for the configuration q of the hand.
  void forward(const Vector& q, std::vector<std::vector<Pose>>& T_hand_step) const;
  /// Returns the largest fingertip radius [m].
  double tip_radius() const;
  /// Returns whether this hand axis moves more than one finger.
  bool shared(int axis) const;

  HandModel hand;                   ///< the hand as its description has it
  std::vector<FingerChain> chains;  ///< one for each finger, in the order of the hand model
  HandShape shape;                  ///< solids of palm and fingers
};

/// One a finger, in their order.
using FingerWorkspaces = std::vector<FingerWorkspace>;
/// Samples the workspace of each finger of the hand.
FingerWorkspaces make_workspaces(const HandGeometry& hand_geometry,
                                 const WorkspaceSettings& settings = {});

/// Returns the settings with the max force of a finger that the description of the hand gives,
/// where there is one.
GripForceSettings limits_of(const HandModel& hand, const GripForceSettings& settings);

}  // namespace handsel::grasp_planner
