// SPDX-License-Identifier: Apache-2.0
// How fast the path is wanted to run: the strictest of what the guard, attention, the supervisor,
// the forecast and the human-aware cost ahead ask for. Pure, no heap.
#pragma once

#include "components/trajectory_controller/input/inputs.hpp"
#include "components/trajectory_controller/supervise/guard.hpp"

namespace handsel::trajectory_controller {

/// How inputs lower the speed.
struct SpeedSettings {
  double attention_lost_factor{0.2};  ///< speed factor while attention is silent
  double attention_timeout{0.3};      ///< attention is silent without advice for so long [s]
  double recoil_limit{1.0};           ///< largest speed factor back along the path, [0, 1]
  double forecast_hold{0.6};          ///< collision forecast within this time: 0 [s]
  double forecast_slow{2.0};          ///< within this time: slower in proportion [s]
  double cost_from{0.5};    ///< human-aware cost ahead from which the arm is slower, [0, 1)
  double cost_factor{0.4};  ///< speed factor at a cost of 1, (0, 1]
};

/// Returns the speed factor for the human-aware cost ahead on the trajectory that runs (chapter
/// section 2), smoothly lower from cost_from on; 1 in a handover, where the cost is meant to be
/// high, and without a forecast of `trajectory` (id).
double cost_factor(const SpeedSettings& settings, const Inputs& inputs,
                   std::uint64_t trajectory) noexcept;

/// Returns the wanted speed factor of the trajectory that runs, [-1, 1].
double wanted_factor(const SpeedSettings& settings, const Inputs& inputs, std::uint64_t trajectory,
                     const GuardVerdict& guard, TimePoint now) noexcept;

/// Returns whether attention asks for a motion away from a person, back along or beside the path;
/// false while a handover has a partner. `attention_timeout`: older advice does not count [s].
bool asks_for_recoil(const Inputs& inputs, double attention_timeout, TimePoint now) noexcept;

}  // namespace handsel::trajectory_controller
