// SPDX-License-Identifier: Apache-2.0
// Finds faults of a robot's description that show only in motion: pairs of links that always touch,
// wrong signs of mimic joints, a tool frame that points into the arm, limits that make no sense.
#pragma once

#include <string>
#include <vector>

#include "common/model/hand_model.hpp"
#include "deploy/handsel/own_robot/collision_matrix.hpp"

namespace handsel {

/// Bounds of what makes sense. Own method.
struct SweepSettings {
  MatrixSettings matrix{.configurations = 20'000};  ///< of the sampling of pairs
  double max_angle{13};                             ///< a larger position limit is in degrees [rad]
  double max_speed{25};          ///< a larger velocity limit is in degrees [rad/s]
  double min_speed{0.01};        ///< a smaller velocity limit moves nothing [rad/s] or [m/s]
  double max_sliding_speed{10};  ///< a larger velocity limit is in millimetres [m/s]
  double max_ramp{5};            ///< max time from rest to the velocity limit [s]
  double max_drift{0.5};         ///< of the middle between two pads, of the change of their gap
};

/// Returns what a robot's sampled motions show to be wrong, one sentence each. `hand`: of its group
/// "hand"; nullptr: not checked.
std::vector<std::string> sweep_faults(const RobotModel& robot, const HandModel* hand,
                                      const SweepSettings& settings = {});

}  // namespace handsel
