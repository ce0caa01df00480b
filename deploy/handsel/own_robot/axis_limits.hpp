// SPDX-License-Identifier: Apache-2.0
// Limits of velocity, acceleration and jerk of a user's robot, each with its source: URDF, the
// joint_limits.yaml of MoveIt, or an assumption.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel {

/// Assumed limits of axes whose maker gives none, and the limits of planned motion. Own method:
/// values at which the shipped robots move.
struct LimitAssumptions {
  double acceleration_ratio{3};        ///< acceleration / velocity [1/s]
  double min_acceleration{2};          ///< of axes that turn [rad/s^2]
  double max_acceleration{8};          ///< of axes that turn [rad/s^2]
  double jerk_ratio{10};               ///< jerk / acceleration [1/s]
  double sliding_ratio{8};             ///< acceleration / velocity of axes that slide [1/s]
  double comfort_speed{0.95};          ///< of the first four axes of the arm [rad/s]
  double comfort_wrist_speed{1.57};    ///< of the further axes [rad/s]
  double comfort_sliding_speed{0.08};  ///< of axes that slide [m/s]
  double guard_margin{1.1};            ///< guard / comfort, at least
  double max_speed{25};                ///< a larger velocity is in degrees [rad/s]
};

/// Limits of one axis.
struct AxisLimitSet {
  std::string joint;                          ///< name of the axis
  double velocity{}, acceleration{}, jerk{};  ///< guard and stop [rad/s, rad/s^2, rad/s^3] or [m]
  double comfort_velocity{};                  ///< planning [rad/s] or [m/s]
  double comfort_acceleration{};              ///< planning [rad/s^2] or [m/s^2]
  double comfort_jerk{};                      ///< planning [rad/s^3] or [m/s^3]
  std::string source;                         ///< of the guard limits, as a comment
  bool assumed{};                             ///< acceleration or jerk is assumed
};

/// Values of one joint in joint_limits.yaml; 0: not given.
struct YamlLimits {
  double velocity{}, acceleration{}, jerk{};  ///< max
};

/// Reads the "joint_limits" of a joint_limits.yaml. Throws ConfigError with file and line when a
/// value is no number or below 0, or the file has no joint_limits.
std::map<std::string, YamlLimits> read_joint_limits(const std::filesystem::path& yaml);

/// Returns the limits of all axes of a robot in their order. Throws ConfigError for a velocity that
/// looks like degrees.
std::vector<AxisLimitSet> find_limits(const RobotModel& robot, const Group& arm,
                                      const std::map<std::string, YamlLimits>& given,
                                      const LimitAssumptions& assumed = {});

}  // namespace handsel
