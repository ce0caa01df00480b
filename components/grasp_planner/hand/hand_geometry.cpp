// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/hand/hand_geometry.hpp"

#include <algorithm>

namespace handsel::grasp_planner {
namespace {

std::vector<FingerChain> make_chains(const HandModel& hand) {
  std::vector<FingerChain> chains;
  chains.reserve(hand.fingers().size());
  for (int f = 0; f < static_cast<int>(hand.fingers().size()); ++f) chains.emplace_back(hand, f);
  return chains;
}

}  // namespace

HandGeometry::HandGeometry(const HandModel& hand_model)
    : hand(hand_model), chains(make_chains(hand)), shape(hand, chains) {}

FingerWorkspaces make_workspaces(const HandGeometry& hand_geometry,
                                 const WorkspaceSettings& settings) {
  FingerWorkspaces workspaces;
  for (const FingerChain& c : hand_geometry.chains)
    workspaces.emplace_back(hand_geometry.hand, c, settings);
  return workspaces;
}

void HandGeometry::forward(const Vector& q, std::vector<std::vector<Pose>>& T_hand_step) const {
  T_hand_step.resize(chains.size());
  for (std::size_t f = 0; f < chains.size(); ++f) chains[f].forward(q, T_hand_step[f]);
}

bool HandGeometry::shared(int axis) const {
  return std::count_if(hand.fingers().begin(), hand.fingers().end(), [axis](const Finger& f) {
           return std::find(f.axes.begin(), f.axes.end(), axis) != f.axes.end();
         }) > 1;
}

double HandGeometry::tip_radius() const {
  double radius = 0;
  for (const FingerChain& c : chains) radius = std::max(radius, c.tip_radius());
  return radius;
}

GripForceSettings limits_of(const HandModel& hand, const GripForceSettings& settings) {
  GripForceSettings limits = settings;
  if (hand.grip_force() > 0) limits.max_normal = hand.grip_force();
  return limits;
}

}  // namespace handsel::grasp_planner
