// SPDX-License-Identifier: Apache-2.0
// Grasps of a person's hands about an upright object.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "common/messages/planning.hpp"

namespace handsel::manipulation_planner::rig {

/// A grasp of a person's hand from one side of the object, its fingers level toward the object.
inline PartnerGrasp from_side(double yaw) {
  PartnerGrasp partner;
  partner.id = 7;
  const Vector3 fingers(std::cos(yaw), std::sin(yaw), 0), palm(-std::sin(yaw), std::cos(yaw), 0);
  partner.T_object_wrist.linear().col(0) = palm;
  partner.T_object_wrist.linear().col(1) = fingers.cross(palm);
  partner.T_object_wrist.linear().col(2) = fingers;
  partner.T_object_wrist.translation() = -0.12 * fingers;
  return partner;
}

/// The mirror image of a grasp at an object that is symmetrical to its x-z plane.
inline PartnerGrasp mirrored(const PartnerGrasp& right) {
  const Vector3 across(1, -1, 1);
  PartnerGrasp left = right;
  left.side = Side::left;
  left.id += 100;
  left.T_object_wrist.translation() = across.cwiseProduct(right.T_object_wrist.translation());
  left.T_object_wrist.linear() =
      across.asDiagonal() * right.T_object_wrist.linear() * across.asDiagonal();
  return left;
}

/// Grasps of either hand from eight sides.
inline std::vector<PartnerGrasp> from_all_sides() {
  std::vector<PartnerGrasp> partners;
  for (int k = 0; k < 8; ++k) {
    partners.push_back(from_side(2 * std::numbers::pi * k / 8));
    partners.back().id = static_cast<std::uint64_t>(k);
    partners.push_back(mirrored(partners.back()));
  }
  return partners;
}

}  // namespace handsel::manipulation_planner::rig
