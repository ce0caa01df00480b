// SPDX-License-Identifier: Apache-2.0
#include "components/spark/robots/other_robots.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

namespace handsel::spark {
namespace {

constexpr std::size_t kMaxReports = 32;     // max number of stored reports
constexpr std::size_t kMaxOtherRobots = 4;  // max length of HumanState.robots

/// Returns the distance of the nearest part to the axis of the arm [m].
double distance_of(const OtherRobot& robot, const Coverage& reach) {
  double min_distance = std::numeric_limits<double>::infinity();
  for (const MovingPart& part : robot.parts)
    min_distance = std::min(min_distance, distance_to_arm(0.5 * (part.a + part.b), reach) -
                                              0.5 * (part.b - part.a).norm() - part.radius);
  return min_distance;
}

}  // namespace

OtherRobots::OtherRobots(const settings::SparkSettings& settings, std::string own_name)
    : settings_(settings), own_name_(std::move(own_name)) {}

void OtherRobots::observe(const RobotReport& report, TimePoint seen) {
  if (report.robot == own_name_ || report.parts.empty()) return;
  const auto known = reports_.find(report.robot);
  if (known == reports_.end()) {
    if (reports_.size() < kMaxReports) reports_[report.robot] = {report.parts, seen};
  } else if (seen >= known->second.seen) {
    known->second = {report.parts, seen};
  }
}

std::vector<OtherRobot> OtherRobots::robots(TimePoint now, const Coverage& reach,
                                            LeftOut* left_out) const {
  std::vector<std::pair<double, OtherRobot>> found;
  for (const auto& [name, report] : reports_) {
    OtherRobot robot{name, report.parts, std::max(0.0, to_seconds(now - report.seen))};
    // The motion of a silent robot is unknown beyond this time.
    const double ahead = std::min(robot.age, settings_.robot_ahead);
    for (MovingPart& part : robot.parts) {
      part.a += ahead * part.velocity_a;
      part.b += ahead * part.velocity_b;
      part.radius += settings_.robot_margin;
      if (robot.age <= settings_.robot_silent_after) continue;
      part.velocity_a.setZero();
      part.velocity_b.setZero();
    }
    found.emplace_back(distance_of(robot, reach), std::move(robot));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<OtherRobot> nearest;
  for (std::size_t i = 0; i < std::min(found.size(), kMaxOtherRobots); ++i)
    nearest.push_back(std::move(found[i].second));
  if (left_out != nullptr && found.size() > kMaxOtherRobots)
    *left_out = {static_cast<std::uint32_t>(found.size() - kMaxOtherRobots),
                 found[kMaxOtherRobots].first};
  return nearest;
}

std::string OtherRobots::trouble(TimePoint now) const {
  std::string out;
  for (const auto& [name, report] : reports_) {
    const double age = to_seconds(now - report.seen);
    if (age <= settings_.robot_silent_after) continue;
    char text[200];
    std::snprintf(text, sizeof text,
                  "robot %s has not been reported for %.0f s and is taken to stand where it was",
                  name.c_str(), age);
    out += (out.empty() ? "" : "; ") + std::string(text);
  }
  return out;
}

}  // namespace handsel::spark
