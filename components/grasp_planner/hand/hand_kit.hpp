// What grasping needs to know of a hand, whatever the object: chains and solids; its workspaces apart, because they take a moment to make.
#pragma once

#include <vector>

#include "components/grasp_planner/hand/finger_chain.hpp"
#include "components/grasp_planner/hand/finger_workspace.hpp"
#include "components/grasp_planner/hand/hand_shape.hpp"

namespace handsel::grasp_planner {

struct HandKit {
  explicit HandKit(const HandModel& hand_model);

  /// Step poses of every finger for the posture q of the hand.
  void forward(const Vector& q, std::vector<std::vector<Pose>>& T_hand_step) const;
  /// Largest fingertip radius [m].
  double tip_radius() const;
  /// Does this hand axis move more than one finger?
  bool shared(int axis) const;

  HandModel hand;
  std::vector<FingerChain> chains;
  HandShape shape;
};

/// One a finger, in their order.
using FingerWorkspaces = std::vector<FingerWorkspace>;
FingerWorkspaces make_workspaces(const HandKit& kit, const WorkspaceSettings& settings = {});

}  // namespace handsel::grasp_planner
