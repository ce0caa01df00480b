// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/pair/load_share.hpp"

#include <algorithm>
#include <limits>

namespace handsel::grasp_planner {
namespace {

constexpr double kGravity = 9.81;    // [m/s^2]
constexpr double kMinEffort = 0.05;  // [Nm] below it no effort is commanded

}  // namespace

GripLoad carried_load(double mass, const Eigen::Matrix3d& R_world_object,
                      const GripForceSettings& settings) {
  return {-mass * kGravity * (R_world_object.transpose() * Vector3::UnitZ()),
          mass * std::max(0.0, settings.acceleration - kGravity)};
}

std::vector<LoadShare> share_load(const std::vector<BearingHand>& hands, const Vector3& centre,
                                  const GripLoad& load, const GripForceSettings& settings) {
  std::vector<std::vector<PointContact>> contacts(hands.size());
  for (std::size_t h = 0; h < hands.size(); ++h)
    for (const Contact& c : hands[h].grasp->contacts)
      contacts[h].push_back({c.position, -c.normal, c.friction});
  // The max normal force of all hands is that of the weakest hand.
  GripForceSettings limits = limits_of(hands.front().hand_geometry->hand, settings);
  for (const BearingHand& h : hands)
    limits.max_normal =
        std::min(limits.max_normal, limits_of(h.hand_geometry->hand, settings).max_normal);
  const std::vector<GripForces> grips = shared_grip_forces(contacts, centre, load, limits);
  std::vector<LoadShare> out(hands.size());
  for (std::size_t h = 0; h < hands.size(); ++h) {
    const auto& [hand_geometry, grasp] = hands[h];
    const std::vector<Vector3>& forces = grips[h].forces;
    out[h].margin = forces.empty() ? -std::numeric_limits<double>::infinity() : grips[h].margin;
    if (forces.empty()) continue;
    Vector effort = Vector::Zero(grasp->hand_joints.size());
    std::vector<std::vector<Pose>> T_hand_step;
    hand_geometry->forward(grasp->hand_joints, T_hand_step);
    const Pose T_hand_object = grasp->T_object_hand.inverse();
    for (std::size_t k = 0; k < forces.size(); ++k) {
      const Contact& c = grasp->contacts[k];
      hand_geometry->chains[c.finger].add_effort(T_hand_step[c.finger], T_hand_object, c.position,
                                                 forces[k], effort);
    }
    if (effort.allFinite() && effort.cwiseAbs().maxCoeff() >= kMinEffort)
      out[h].effort = std::move(effort);
  }
  return out;
}

LoadShare bear_part(const BearingHand& hand, double part, const GripLoad& load,
                    const GripForceSettings& settings) {
  Vector3 middle = Vector3::Zero();
  for (const Contact& c : hand.grasp->contacts)
    middle += c.position / static_cast<double>(hand.grasp->contacts.size());
  return share_load({hand}, middle, {part * load.weight, part * load.shake}, settings).front();
}

}  // namespace handsel::grasp_planner
