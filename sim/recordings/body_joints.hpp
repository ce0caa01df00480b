// SPDX-License-Identifier: Apache-2.0
// Indices of the joints of a body; of pairs, the left one comes first.
#pragma once

#include "common/model/human/human_body.hpp"

namespace handsel::sim {

inline const int kShoulder[2] = {body_joint_index("l_shoulder"), body_joint_index("r_shoulder")};
inline const int kElbow[2] = {body_joint_index("l_elbow"), body_joint_index("r_elbow")};
inline const int kWrist[2] = {body_joint_index("l_wrist"), body_joint_index("r_wrist")};
inline const int kHand[2] = {body_joint_index("l_hand"), body_joint_index("r_hand")};
inline const int kHead = body_joint_index("head"), kTorso = body_joint_index("torso"),
                 kWaist = body_joint_index("waist"), kNeck = body_joint_index("neck");

}  // namespace handsel::sim
