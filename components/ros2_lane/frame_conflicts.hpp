// SPDX-License-Identifier: Apache-2.0
// Frames from outside that have the name of a link which this process sends itself. Pure.
#pragma once

#include <map>
#include <string>

#include "common/messages/ros2.hpp"
#include "components/ros2_lane/recent_report.hpp"

namespace handsel::ros2_lane {

/// Finds frames of TF that contradict the robot's own links.
class FrameConflicts {
 public:
  explicit FrameConflicts(std::string robot) : robot_(std::move(robot)) {}

  /// Sets the parent of each link that TF gets from this process, by link: no other process may
  /// send those frames.
  void set_own(std::map<std::string, std::string> parents) { parents_ = std::move(parents); }
  /// Returns whether the transform places one of the links below another parent; this is reported.
  bool contradicts(const ros2::Transform& transform, TimePoint arrival);
  /// Returns the newest conflict, one sentence; empty: none lately.
  std::string trouble(TimePoint now) const { return report_.current(now); }

 private:
  std::string robot_;
  std::map<std::string, std::string> parents_;
  RecentReport report_;
};

}  // namespace handsel::ros2_lane
