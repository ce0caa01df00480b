// SPDX-License-Identifier: Apache-2.0
// A behaviour defined by settings: one input, a speed factor that falls with the input, a gaze
// target.
#pragma once

#include "components/attention/schema.hpp"

namespace handsel::attention {

class Watch : public Schema {
 public:
  Watch(const Body& body, const MotorSettings& motor, const WatchSettings& settings)
      : body_(body), motor_(motor), settings_(settings) {}
  Behaviour kind() const override { return Behaviour::watch; }
  double perceive(const World& world, TimePoint now) override;
  bool released(const World&) const override { return known_; }
  double speed_factor() const override;
  const char* reason() const override { return settings_.reason.c_str(); }
  std::optional<Vector3> gaze() const override { return gaze_; }

 private:
  double sample(const World& world, TimePoint now);

  const Body& body_;
  MotorSettings motor_;
  WatchSettings settings_;
  bool known_{};  // whether the input is available
  double input_{};
  std::optional<Vector3> gaze_;
  std::optional<TimePoint> seen_;
};

}  // namespace handsel::attention
