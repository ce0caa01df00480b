// SPDX-License-Identifier: Apache-2.0
// Distance zones around the robot with hysteresis in space and time (formulas: section 4). Own
// method: the chapter has no section on attention.
#pragma once

#include <array>

#include "common/base/time.hpp"

namespace handsel::attention {

enum class Zone { contact, danger, interaction, social, far };

/// Limits and hysteresis of the zones.
struct ZoneSettings {
  /// Outer limits of contact, danger, interaction and social zone [m].
  std::array<double, 4> limits{0.1, 0.45, 1.2, 3.6};
  double margin{0.05};  ///< distance beyond the limit at which a zone is left [m]
  double dwell{0.3};    ///< time beyond this distance before a zone is left [s]
};

class ZoneTracker {
 public:
  explicit ZoneTracker(const ZoneSettings& settings) : settings_(settings) {}
  /// Takes a distance [m] and returns the zone; +inf is far. A nearer zone applies immediately.
  Zone update(double distance, TimePoint now);
  /// Returns the zone of the last update(); far before the first.
  Zone zone() const { return zone_; }

 private:
  ZoneSettings settings_;
  Zone zone_{Zone::far};
  bool leaving_{};
  TimePoint since_{};
};

}  // namespace handsel::attention
