// SPDX-License-Identifier: Apache-2.0
// The walk of a person who approaches the robot without regard to its motion. Pure.
#pragma once

namespace handsel::sim {

/// One walk to the place of the person and back; speed 0: none.
struct StepInSettings {
  double at{};     ///< begin, scenario time [s]
  double speed{};  ///< max walking speed [m/s]
  double stays{};  ///< duration of the stay at the place before the walk back [s]
};

/// Returns the distance of the person from the place [m] at `time` [s]: `from` [m] before and after
/// the visit, 0 during the stay. The speed rises and falls with `acceleration` [m/s^2].
double distance_from_place(const StepInSettings& visit, double from, double time,
                           double acceleration);

}  // namespace handsel::sim
