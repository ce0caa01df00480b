// A person who walks up to the robot without regard for it. Pure.
#pragma once

namespace handsel::sim {

/// One walk to the place of the person and back; speed 0: none.
struct StepInSettings {
  double at{};     ///< begin, of scenario time [s]
  double speed{};  ///< of the walk [m/s]
  double stays{};  ///< at the place, before the walk back [s]
};

/// Returns how far the person is from the place [m] at `time` [s]: `from` [m] before and after the
/// visit, 0 during the stay. The speed rises and falls with kMaxStepAcceleration.
double distance_from_place(const StepInSettings& visit, double from, double time);

}  // namespace handsel::sim
