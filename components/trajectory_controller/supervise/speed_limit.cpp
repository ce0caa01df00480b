// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/speed_limit.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

double cost_factor(const SpeedSettings& settings, const Inputs& inputs,
                   std::uint64_t trajectory) noexcept {
  const TrajectoryForecast* forecast = inputs.forecast_of(trajectory);
  if (forecast == nullptr || !inputs.people.partner().empty()) return 1.0;
  const double beyond = (forecast->cost - settings.cost_from) / (1.0 - settings.cost_from);
  const double x = std::clamp(beyond, 0.0, 1.0);
  return 1.0 - x * x * (3.0 - 2.0 * x) * (1.0 - settings.cost_factor);
}

double wanted_factor(const SpeedSettings& settings, const Inputs& inputs, std::uint64_t trajectory,
                     const GuardVerdict& guard, TimePoint now) noexcept {
  const bool silent = inputs.attention_silent(now, settings.attention_timeout);
  const double advised = silent ? settings.attention_lost_factor : inputs.advice.value.speed_factor;
  double wanted = std::min({inputs.permission.go().override_factor, guard.forward, advised});
  wanted = std::min({wanted, cost_factor(settings, inputs, trajectory), guard.view});
  const TrajectoryForecast* forecast = inputs.forecast_of(trajectory);
  if (forecast != nullptr && forecast->collides) {
    const double range = settings.forecast_slow - settings.forecast_hold;
    const double ratio = (forecast->time_to_collision - settings.forecast_hold) / range;
    wanted = std::min(wanted, std::clamp(ratio, 0.0, 1.0));
  }
  return wanted >= 0.0 ? wanted : std::max({wanted, guard.backward, -settings.recoil_limit});
}

bool asks_for_recoil(const Inputs& inputs, double attention_timeout, TimePoint now) noexcept {
  const AttentionAdvice& advice = inputs.advice.value;
  return !inputs.attention_silent(now, attention_timeout) && inputs.people.partner().empty() &&
         (advice.speed_factor < 0.0 || advice.leaves_path);
}

}  // namespace handsel::trajectory_controller
