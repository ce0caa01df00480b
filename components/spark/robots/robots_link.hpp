// SPDX-License-Identifier: Apache-2.0
// Reports the own robot to the other robots of the domain, and takes their reports.
#pragma once

#include <memory>
#include <string>

#include "common/bus/bus.hpp"
#include "common/messages/robot.hpp"
#include "common/model/robot_volume.hpp"
#include "components/spark/robots/other_robots.hpp"

namespace handsel::spark {

class RobotsLink {
 public:
  /// `name`: of the robot in RobotReport; empty: that of its model. Subscribes and publishes on
  /// `bus`, which must outlive this.
  RobotsLink(Bus& bus, const settings::SparkSettings& settings,
             const std::shared_ptr<const RobotModel>& robot, const std::string& name);

  /// Takes the state of the own robot; ignores one with another number of axes.
  void update(const RobotState& state);
  /// Adds the other robots, as they are now, to the people.
  void add_to(HumanState& people, TimePoint now, const Coverage& reach) const;
  /// See OtherRobots::trouble().
  std::string trouble(TimePoint now) const { return others_.trouble(now); }

 private:
  void publish(TimePoint now);

  Bus& bus_;
  OtherRobots others_;
  RobotVolume volume_;
  RobotReport report_;
  RobotState state_;  // of the own robot; without positions: unknown
  double period_{};   // of publishing [s]
  TimePoint published_{};
  std::unique_ptr<Publisher<RobotReport>> out_;
};

}  // namespace handsel::spark
