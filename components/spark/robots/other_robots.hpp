// SPDX-License-Identifier: Apache-2.0
// Tracks the other robots from their own reports. Pure. Own method.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"
#include "components/spark/quotas.hpp"

namespace handsel::spark {

/// Other robots as obstacles; a silent robot remains one at its last reported place.
class OtherRobots {
 public:
  /// `own_name`: reports under this name are those of the robot itself.
  OtherRobots(const settings::SparkSettings& settings, std::string own_name);

  /// Takes a report; ignores one older than the last, without parts, or of the own robot.
  void observe(const RobotReport& report, TimePoint seen);
  /// Returns the other robots extrapolated to `now`, the nearest to the arm first: parts move for
  /// at most robot_ahead [s] and grow by robot_margin [m]. Counts omitted robots in `left_out`.
  std::vector<OtherRobot> robots(TimePoint now, const Coverage& reach,
                                 LeftOut* left_out = nullptr) const;
  /// Returns one sentence about the robots that are silent for longer than robot_silent_after;
  /// empty: none.
  std::string trouble(TimePoint now) const;

 private:
  struct Report {
    std::vector<MovingPart> parts;
    TimePoint seen;
  };

  settings::SparkSettings settings_;
  std::string own_name_;
  std::map<std::string, Report> reports_;  // by name of the robot
};

}  // namespace handsel::spark
