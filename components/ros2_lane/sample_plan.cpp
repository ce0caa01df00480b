// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/sample_plan.hpp"

#include <algorithm>

namespace handsel::ros2_lane {

namespace {

AdvisedPeriod period_of(double rate, double min_rate) {
  return {1 / rate, 1 / std::min(rate, min_rate), 1 / rate};
}

bool is_due(AdvisedPeriod& period, TimePoint now) {
  if (!period.due(now)) return false;
  period.done(now);
  return true;
}

}  // namespace

SamplePlan::SamplePlan(const settings::Ros2LaneSettings& settings)
    : people_source_(settings.people_source),
      objects_source_(settings.objects_source),
      people_(period_of(settings.people_rate, settings.min_rate)),
      objects_(period_of(settings.objects_rate, settings.min_rate)) {}

void SamplePlan::request(const SensorRequest& request, TimePoint now) {
  const auto concerns = [&](const std::string& source) {
    return request.source.empty() || request.source == source;
  };
  if (concerns(people_source_)) {
    people_.advise(request.people_rate > 0 ? 1 / request.people_rate : 0, now);
    hands_ = request.hands;
  }
  const double rate =
      request.objects_rate > 0 ? std::max(request.objects_rate, request.region_rate) : 0;
  if (concerns(objects_source_)) objects_.advise(rate > 0 ? 1 / rate : 0, now);
}

bool SamplePlan::people_due(TimePoint now) { return is_due(people_, now); }

bool SamplePlan::objects_due(TimePoint now) { return is_due(objects_, now); }

}  // namespace handsel::ros2_lane
