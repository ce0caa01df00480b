// SPDX-License-Identifier: Apache-2.0
// For the sources of PersonModel: profiles of motion.
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/people/person_settings.hpp"
#include "sim/recordings/body_joints.hpp"

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

}  // namespace handsel::sim
