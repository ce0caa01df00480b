// SPDX-License-Identifier: Apache-2.0
#include "components/attention/zones.hpp"

namespace handsel::attention {

namespace {
Zone zone_of(double distance, const ZoneSettings& s) {
  for (std::size_t i = 0; i < s.limits.size(); ++i)
    if (distance < s.limits[i]) return static_cast<Zone>(i);
  return Zone::far;
}
}  // namespace

Zone ZoneTracker::update(double distance, TimePoint now) {
  const Zone nearer = zone_of(distance, settings_);
  if (nearer <= zone_) {
    if (nearer < zone_) zone_ = nearer;
    leaving_ = false;
    return zone_;
  }
  const Zone outside = zone_of(distance - settings_.margin, settings_);
  if (outside <= zone_) {
    leaving_ = false;
  } else if (!leaving_) {
    leaving_ = true;
    since_ = now;
  } else if (to_seconds(now - since_) >= settings_.dwell) {
    zone_ = outside;
    leaving_ = false;
  }
  return zone_;
}

}  // namespace handsel::attention
