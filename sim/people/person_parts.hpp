// SPDX-License-Identifier: Apache-2.0
// For the sources of PersonModel: indices of joints, profiles of motion.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/model/human/human_body.hpp"
#include "sim/people/person_settings.hpp"

namespace handsel::sim {

/// Returns the minimum-jerk profile from 0 to 1 (Flash and Hogan 1985); s is limited to [0, 1].
inline double min_jerk(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

/// Returns the duration of a minimum-jerk step of `length` [m] at walking speed, but with at most
/// the max acceleration [s].
inline double step_time(double length, const PersonManners& manners) {
  constexpr double kPeak = 5.7735;  // max second derivative of min_jerk(): 10 / sqrt(3)
  return std::max(length / manners.person_walk_speed,
                  std::sqrt(kPeak * length / manners.person_max_step_acceleration));
}

inline const int kShoulder[2] = {body_joint_index("l_shoulder"), body_joint_index("r_shoulder")};
inline const int kElbow[2] = {body_joint_index("l_elbow"), body_joint_index("r_elbow")};
inline const int kWrist[2] = {body_joint_index("l_wrist"), body_joint_index("r_wrist")};
inline const int kHand[2] = {body_joint_index("l_hand"), body_joint_index("r_hand")};
inline const int kHead = body_joint_index("head"), kTorso = body_joint_index("torso"),
                 kWaist = body_joint_index("waist"), kNeck = body_joint_index("neck");

}  // namespace handsel::sim
