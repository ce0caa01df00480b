// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/contact_budget.hpp"

#include <cmath>

namespace handsel::trajectory_controller {

BodyRegion region_of(BodyPart part) noexcept {
  switch (part) {
    case BodyPart::head:
      return BodyRegion::head;
    case BodyPart::torso:
      return BodyRegion::torso;
    case BodyPart::upper_arm_left:
    case BodyPart::upper_arm_right:
      return BodyRegion::upper_arm;
    case BodyPart::forearm_left:
    case BodyPart::forearm_right:
      return BodyRegion::forearm;
    case BodyPart::hand_left:
    case BodyPart::hand_right:
      return BodyRegion::hand;
    case BodyPart::leg_left:
    case BodyPart::leg_right:
      return BodyRegion::lower_leg;
  }
  return BodyRegion::head;
}

double max_contact_speed(const ContactLimit& limit, double robot_mass) noexcept {
  return std::sqrt(2.0 * limit.energy() / reduced_mass(limit, robot_mass));
}

}  // namespace handsel::trajectory_controller
