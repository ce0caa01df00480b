// SPDX-License-Identifier: Apache-2.0
// Grasps of people on an upright object.
#pragma once

#include <cmath>
#include <vector>

#include "common/messages/planning.hpp"

namespace handsel::test {

/// Grasps of either hand of a person from four sides of an upright object, the thumb up.
inline std::vector<PartnerGrasp> grasps_of_both_hands() {
  std::vector<PartnerGrasp> grasps;
  for (const Side side : {Side::right, Side::left}) {
    for (int k = 0; k < 4; ++k) {
      const double yaw = 1.5707963 * k, sign = side == Side::right ? 1 : -1;
      PartnerGrasp grasp;
      grasp.id = grasps.size();
      grasp.side = side;
      const Vector3 fingers(std::cos(yaw), std::sin(yaw), 0);
      const Vector3 palm = sign * Vector3(-std::sin(yaw), std::cos(yaw), 0);
      grasp.T_object_wrist.linear() << palm, fingers.cross(palm), fingers;
      grasp.T_object_wrist.translation() = -0.12 * fingers;
      grasps.push_back(grasp);
    }
  }
  return grasps;
}

}  // namespace handsel::test
