// SPDX-License-Identifier: Apache-2.0
// For the sources of PersonModel: indices of joints, and constants common to all behaviours.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/model/human/human_body.hpp"

namespace handsel::sim {

/// Grip force beyond which the person releases the object [N].
inline constexpr double kMaxToleratedForce = 30.0;
/// Min distance of an offer from the robot's hand [m].
inline constexpr double kMinHandDistance = 0.5;
/// Distance of an object's origin ahead of a fist that holds the object unturned [m].
inline constexpr double kObjectAhead = 0.08;
inline constexpr double kWalkSpeed = 0.6;   ///< mean walking speed [m/s]
inline constexpr double kMaxLean = 0.35;    ///< max lean of the trunk forward [rad]
inline constexpr double kCloseTime = 0.25;  ///< duration of closing the hand [s]
/// Fraction of a reach at which a person hesitates or withdraws.
inline constexpr double kMidwayFraction = 0.55;

/// Returns the minimum-jerk profile from 0 to 1 (Flash and Hogan 1985); s is limited to [0, 1].
inline double min_jerk(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

/// Max accelerations of a rushing person, as assumed by the controller's stop proof [m/s^2].
inline constexpr double kMaxHandAcceleration = 50.0, kMaxTrunkAcceleration = 10.0;
/// Peak acceleration of the trunk in a short step [m/s^2]; a rapid voluntary step from standing has
/// 3 to 4 m/s^2.
inline constexpr double kMaxStepAcceleration = 4.0;

/// Returns the duration of a minimum-jerk step of `length` [m] at walking speed [s]; the peak
/// acceleration is at most kMaxStepAcceleration.
inline double step_time(double length) {
  constexpr double kPeak = 5.7735;  // max second derivative of min_jerk(): 10 / sqrt(3)
  return std::max(length / kWalkSpeed, std::sqrt(kPeak * length / kMaxStepAcceleration));
}

inline const int kShoulder[2] = {body_joint_index("l_shoulder"), body_joint_index("r_shoulder")};
inline const int kElbow[2] = {body_joint_index("l_elbow"), body_joint_index("r_elbow")};
inline const int kWrist[2] = {body_joint_index("l_wrist"), body_joint_index("r_wrist")};
inline const int kHand[2] = {body_joint_index("l_hand"), body_joint_index("r_hand")};
inline const int kHead = body_joint_index("head"), kTorso = body_joint_index("torso"),
                 kWaist = body_joint_index("waist"), kNeck = body_joint_index("neck");

}  // namespace handsel::sim
