// SPDX-License-Identifier: Apache-2.0
// Where parts of people can be by a given time: their measured state as start, speed and
// acceleration bounded. Pure.
#pragma once

#include <array>

#include "components/trajectory_controller/input/person_capsules.hpp"
#include "components/trajectory_controller/supervise/stop/contact_budget.hpp"

namespace handsel::trajectory_controller {

/// Largest speed and acceleration of one body region.
struct RegionMotion {
  double speed{};         ///< [m/s]
  double acceleration{};  ///< [m/s^2]
};
using RegionMotions = std::array<RegionMotion, kBodyRegions>;

/// Returns how far a point that moves with `speed` [m/s] in an unknown direction can be from its
/// place after `time` [s], when the bounds hold [m]. A speed above the bound stays as measured.
double reach_after(double time, double speed, const RegionMotion& bounds) noexcept;

/// Returns the speed from which a part starts [m/s]: if `part.measured`, its speed plus
/// `uncertainty`, not capped; else the larger of its speed and the largest of its region.
double start_speed(const PersonCapsule& part, double uncertainty,
                   const RegionMotion& bounds) noexcept;

/// Max distance of each part of all people from its measured position. HumanState carries at most
/// 16 people.
struct PartReaches {
  std::array<double, std::size_t{16} * kBodyCapsules> distance;  ///< [m], the first `count`
  std::size_t count{};  ///< number of capsules in PersonCapsules
};

/// Computes the reaches `time` [s] after now, to which the age of each part is added. `uncertainty`
/// as of start_speed() [m/s]. Allocates nothing.
void reach_of_parts(const PersonCapsules& people, double time, double uncertainty,
                    const RegionMotions& bounds, PartReaches& out) noexcept;

}  // namespace handsel::trajectory_controller
