// SPDX-License-Identifier: Apache-2.0
// The joints of a complete body by number, in the order of kBodyJoints.
#pragma once

#include <array>

#include "common/model/human/human_body.hpp"

namespace handsel::body {

// NOLINTBEGIN(readability-identifier-naming): the names of the joints as on the wire
enum Index {
  head,
  neck,
  torso,
  waist,
  l_shoulder,
  l_elbow,
  l_wrist,
  l_hand,
  r_shoulder,
  r_elbow,
  r_wrist,
  r_hand,
  l_hip,
  l_knee,
  l_ankle,
  r_hip,
  r_knee,
  r_ankle
};
// NOLINTEND(readability-identifier-naming)

using Points = std::array<Vector3, kBodyJoints.size()>;

}  // namespace handsel::body
