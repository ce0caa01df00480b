// SPDX-License-Identifier: Apache-2.0
// The newest samples of all inputs. Pure.
#pragma once

#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "components/trajectory_controller/input/motion_permission.hpp"
#include "components/trajectory_controller/input/observed_people.hpp"
#include "components/trajectory_controller/input/robot_input.hpp"
#include "components/trajectory_controller/input/sample.hpp"

namespace handsel::trajectory_controller {

struct Inputs {
  RobotInput robot;                     ///< robot state
  ObservedPeople people;                ///< people, views, partner of a handover
  MotionPermission permission;          ///< Go and safety state
  Sample<TrajectoryForecast> forecast;  ///< counts only for the trajectory that runs
  Sample<AttentionAdvice> advice;       ///< of the attentional system

  /// Returns the forecast if it is of this trajectory, else nullptr.
  const TrajectoryForecast* forecast_of(std::uint64_t trajectory) const noexcept {
    return forecast.value.trajectory == trajectory ? &forecast.value : nullptr;
  }
  /// Returns whether there is no advice younger than `timeout` [s].
  bool attention_silent(TimePoint now, double timeout) const noexcept {
    const double age = advice.time.age(now);
    return age < 0 || age > timeout;
  }
};

}  // namespace handsel::trajectory_controller
