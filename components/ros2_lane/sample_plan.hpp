// SPDX-License-Identifier: Apache-2.0
// When people and objects are sampled from TF: at the rates of the settings, or as attention
// requests. Pure.
#pragma once

#include <string>

#include "common/base/advised_period.hpp"
#include "common/config/settings/ros2_lane.hpp"
#include "common/messages/attention.hpp"

namespace handsel::ros2_lane {

/// Times of the samples of both observations. A request expires after 0.3 s.
class SamplePlan {
 public:
  explicit SamplePlan(const settings::Ros2LaneSettings& settings);

  /// Takes a request; ignores those to other sources. Objects are sampled as often as the request
  /// wants any of them.
  void request(const SensorRequest&, TimePoint now);
  /// Returns whether a sample of people is due, and begins the next period.
  bool people_due(TimePoint now);
  /// Returns whether a sample of objects is due, and begins the next period.
  bool objects_due(TimePoint now);
  /// Returns whether knuckles belong to the samples of people.
  bool samples_knuckles(TimePoint now) const { return hands_ || !people_.is_advised(now); }

 private:
  std::string people_source_, objects_source_;
  AdvisedPeriod people_, objects_;
  bool hands_{true};
};

}  // namespace handsel::ros2_lane
