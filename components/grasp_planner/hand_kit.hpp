// Everything about a hand that grasping needs and no object changes: chains, workspaces, solids. Made once a hand.
#pragma once

#include <vector>

#include "components/grasp_planner/finger_chain.hpp"
#include "components/grasp_planner/finger_workspace.hpp"
#include "components/grasp_planner/hand_shape.hpp"

namespace handsel::grasp_planner {

struct HandKit {
  explicit HandKit(const HandModel& hand_model, const WorkspaceSettings& settings = {});

  /// Step poses of every finger for the posture q of the hand.
  void forward(const Vector& q, std::vector<std::vector<Pose>>& T_hand_step) const;
  /// Largest fingertip radius [m].
  double tip_radius() const;

  HandModel hand;
  std::vector<FingerChain> chains;
  std::vector<FingerWorkspace> workspaces;
  HandShape shape;
};

}  // namespace handsel::grasp_planner
