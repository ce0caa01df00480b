// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/speed_rise.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

void SpeedRise::lower(double factor) noexcept {
  ceiling_ = std::min(ceiling_, settings_.unproven_ratio * std::abs(factor));
}

void SpeedRise::note(double limit) noexcept { allowed_ = std::min(allowed_, limit); }

SpeedLimit SpeedRise::next(const SpeedLimit& limit) noexcept {
  ceiling_ = std::min(1.0, ceiling_ + settings_.unproven_rate * settings_.period);
  allowed_ = std::min({limit.factor, allowed_ + settings_.rate * settings_.period, ceiling_});
  if (allowed_ < limit.factor)
    return {allowed_, limit.people || by_people_, limit.wall || by_wall_};
  by_people_ = limit.people;
  by_wall_ = limit.wall;
  return limit;
}

}  // namespace handsel::trajectory_controller
