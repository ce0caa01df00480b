// SPDX-License-Identifier: Apache-2.0
// Simulates odometry and localisation of a mobile robot: the odometry has errors that accumulate;
// the localisation estimates the pose of the odometry frame at its own rate. Own method: errors in
// proportion to the square root of the distance.
#pragma once

#include <random>

#include "common/model/platform.hpp"
#include "common/robot_side/robot_side.hpp"

namespace handsel::sim {

struct OdometrySettings {
  double noise{0.01};       ///< standard deviation of the position after 1 m [m]
  double turn_noise{0.01};  ///< standard deviation of the heading after 1 m or 1 rad [rad]
};

struct LocalisationSettings {
  double rate{10};           ///< rate of the localisation [Hz]
  double noise{0.01};        ///< standard deviation of a measured position [m]
  double turn_noise{0.005};  ///< standard deviation of a measured heading [rad]
  double filter_time{0.5};   ///< time constant of the filter of measurements [s]
};

/// A pose in the plane: x, y [m] and heading [rad].
using Place = Vector3;

class PlatformOdometry {
 public:
  /// `robot` has a platform. `start`: all axes; there the odometry frame equals the root frame.
  PlatformOdometry(const RobotModel& robot, const Vector& start, const OdometrySettings& odometry,
                   const LocalisationSettings& localisation, std::uint64_t seed);

  /// Updates odometry and localisation after a step. `position`: all axes, root frame; `now` [s].
  void advance(const Vector& position, double now);
  /// Converts a reference of the robot side from the odometry frame to the root frame.
  void to_root(Vector& position, Vector& velocity, Vector& acceleration) const;
  /// Returns the positions of all axes as measured by the robot side: in the odometry frame.
  Vector measured_position(const Vector& position) const;
  /// Returns the velocities of all axes in the odometry frame.
  Vector measured_velocity(const Vector& velocity) const;
  /// Returns the estimated pose of the odometry frame in the root frame.
  Pose T_root_odometry() const;
  /// Returns the time since the last estimate of the localisation [s].
  double age(double now) const { return now - found_; }

  /// Stops the localisation until this time [s].
  void lose(double until) { lost_until_ = until; }
  /// Shifts all further estimates of the localisation along x [m].
  void shift(double distance) { shift_ = distance; }
  /// Starts a slip of `distance` [m] in total: the wheels roll 0.5 m per metre driven in addition
  /// to the motion of the platform.
  void slip(double distance) { to_slip_ = distance; }

 private:
  double draw(double sigma) { return sigma > 0 ? sigma * normal_(random_) : 0; }
  Place place_of(const Vector& all) const;
  void localise(double now);

  std::vector<int> axes_;
  OdometrySettings odometry_;
  LocalisationSettings localisation_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
  Place actual_, measured_;        // platform in the root frame, in the odometry frame
  Place offset_;                   // odometry frame in the root frame
  Place estimate_{Place::Zero()};  // estimate of offset_ by the localisation
  double next_{0}, found_{0}, lost_until_{0}, shift_{0}, to_slip_{0};
};

}  // namespace handsel::sim
