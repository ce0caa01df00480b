// SPDX-License-Identifier: Apache-2.0
#include "components/attention/adaptive_clock.hpp"

#include <algorithm>

#include "common/base/errors.hpp"

namespace handsel::attention {

double margin_period(double distance, double delay, const MarginSettings& margin) {
  return margin.use * (distance - margin.distance) / (margin.person_speed + margin.robot_speed) -
         margin.data_age - delay;
}

AdaptiveClock::AdaptiveClock(const ClockSettings& settings, Duration slack, const std::string& what)
    : settings_(settings), slack_(slack), period_(settings.p_min) {
  if (!(settings.p_min > 0))
    throw ConfigError("attention: behaviour " + what + ": p_min must be above 0 s");
  if (!(settings.p_max >= settings.p_min))
    throw ConfigError("attention: behaviour " + what + ": p_max must not be below p_min");
  if (!(settings.far > settings.near))
    throw ConfigError("attention: behaviour " + what + ": far must be above near");
  if (!(settings.weber_gain > 0))
    throw ConfigError("attention: behaviour " + what + ": weber_gain must be above 0");
  if (settings.rule == ClockLaw::fixed &&
      !(settings.period >= settings.p_min && settings.period <= settings.p_max))
    throw ConfigError("attention: behaviour " + what +
                      ": period must be from p_min to p_max where the law is FIXED");
  const MarginSettings& margin = settings.margin;
  if (settings.rule == ClockLaw::margin &&
      !(margin.use > 0 && margin.use < 1 && margin.person_speed > 0 && margin.robot_speed >= 0))
    throw ConfigError("attention: behaviour " + what +
                      ": margin_use must be in (0, 1), person_speed above 0 and robot_speed not "
                      "below 0 where the law is MARGIN");
}

void AdaptiveClock::fire(double stimulus, TimePoint now) {
  const double s =
      std::isfinite(stimulus) ? std::clamp(stimulus, 0.0, settings_.far) : settings_.far;
  if (settings_.rule == ClockLaw::fixed) {
    period_ = settings_.period;
  } else if (settings_.rule == ClockLaw::margin) {
    period_ = margin_period(stimulus, to_seconds(slack_), settings_.margin);
  } else if (settings_.rule == ClockLaw::linear) {
    period_ =
        settings_.p_max * (0.1 + 0.9 * (s - settings_.near) / (settings_.far - settings_.near));
  } else {
    const double floor = 0.01 * settings_.far;
    const double before = activations_ == 0 ? settings_.far : previous_;
    if (activations_ == 0) period_ = settings_.p_max;
    period_ *= std::max(0.0, 1.0 + settings_.weber_gain * (s - before) / std::max(before, floor));
    if (s >= settings_.far) period_ = settings_.p_max;
  }
  period_ = std::clamp(period_, settings_.p_min, settings_.p_max);
  previous_ = s;
  if (!started_) first_ = now;
  started_ = true;
  next_ = now + from_seconds(period_);
  ++activations_;
}

std::uint64_t AdaptiveClock::activations_at_fastest(TimePoint now) const {
  return started_ ? 1 + static_cast<std::uint64_t>(std::max(0.0, to_seconds(now - first_)) /
                                                   settings_.p_min)
                  : 0;
}

}  // namespace handsel::attention
