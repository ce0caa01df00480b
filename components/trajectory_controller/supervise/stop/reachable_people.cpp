// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/reachable_people.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

double reach_after(double time, double speed, const RegionMotion& bounds) noexcept {
  if (time <= 0.0) return 0.0;
  if (speed >= bounds.speed) return speed * time;
  const double until_fastest = (bounds.speed - speed) / bounds.acceleration;
  if (time <= until_fastest) return (speed + 0.5 * bounds.acceleration * time) * time;
  return (speed + 0.5 * bounds.acceleration * until_fastest) * until_fastest +
         bounds.speed * (time - until_fastest);
}

double start_speed(const PersonCapsule& part, double uncertainty,
                   const RegionMotion& bounds) noexcept {
  return part.measured ? part.fastest + uncertainty : std::max(part.fastest, bounds.speed);
}

void reach_of_parts(const PersonCapsules& people, double time, double uncertainty,
                    const RegionMotions& bounds, PartReaches& out) noexcept {
  out.count = std::min(people.capsules.size(), out.distance.size());
  for (std::size_t p = 0; p < out.count; ++p) {
    const PersonCapsule& part = people.capsules[p];
    const RegionMotion& region = bounds[static_cast<std::size_t>(part.region)];
    out.distance[p] = reach_after(time + part.age, start_speed(part, uncertainty, region), region);
  }
}

}  // namespace handsel::trajectory_controller
