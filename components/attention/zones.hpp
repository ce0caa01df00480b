// Distance zones around the robot with hysteresis in space and time (formulas: section 4; ours).
#pragma once

#include <array>

#include "common/base/time.hpp"

namespace handsel::attention {

enum class Zone { contact, danger, interaction, social, far };

struct ZoneSettings {
  std::array<double, 4> limits{0.1, 0.45, 1.2, 3.6};  ///< outer limits of contact, danger, interaction, social [m]
  double margin{0.05};                                ///< a zone is left only beyond its limit plus this [m]
  double dwell{0.3};                                  ///< and only after this long [s]; coming nearer counts at once
};

class ZoneTracker {
 public:
  explicit ZoneTracker(const ZoneSettings& settings) : settings_(settings) {}
  Zone update(double distance, TimePoint now);
  Zone zone() const { return zone_; }

 private:
  ZoneSettings settings_;
  Zone zone_{Zone::far};
  bool leaving_{};
  TimePoint since_{};
};

}  // namespace handsel::attention
