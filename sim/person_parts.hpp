// For the sources of PersonModel: places of joints, and numbers its behaviours share.
#pragma once

#include <algorithm>

#include "common/model/human_body.hpp"

namespace handsel::sim {

inline constexpr double kSoreForce = 30.0;  ///< beyond this the person lets go [N]
inline constexpr double kWalkSpeed = 0.6;   ///< mean [m/s]
inline constexpr double kMidway = 0.55;     ///< of a reach: who hesitates or changes their mind does so there

inline double min_jerk(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

inline const int kShoulder[2] = {body_joint_index("l_shoulder"), body_joint_index("r_shoulder")};
inline const int kElbow[2] = {body_joint_index("l_elbow"), body_joint_index("r_elbow")};
inline const int kWrist[2] = {body_joint_index("l_wrist"), body_joint_index("r_wrist")};
inline const int kHand[2] = {body_joint_index("l_hand"), body_joint_index("r_hand")};
inline const int kHead = body_joint_index("head"), kTorso = body_joint_index("torso"), kWaist = body_joint_index("waist"),
                 kNeck = body_joint_index("neck");

}  // namespace handsel::sim
