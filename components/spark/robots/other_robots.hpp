// The other robots around, from what they report about themselves. Pure. Own method.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"
#include "components/spark/quotas.hpp"

namespace handsel::spark {

/// A robot that is silent is taken to stand where it was reported last: it stays an obstacle.
class OtherRobots {
 public:
  /// `own_name`: reports under this name are those of the robot itself.
  OtherRobots(const settings::SparkSettings& settings, std::string own_name);

  /// Takes a report. Older ones than the last, those without parts, and those of the robot itself
  /// change nothing.
  void observe(const RobotReport& report, TimePoint seen);
  /// Returns the other robots as they are expected to be now, the nearest to the arm first: their
  /// parts are moved on for at most robot_ahead and larger by robot_margin. Writes how many were
  /// left out, when given.
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
