// Odometry and localisation of a robot that drives: the wheels measure how far they roll, with
// errors that add up; a localisation finds at its own rate where the odometry frame is in the
// world. Own method: errors in proportion to the root of the distance.
#pragma once

#include <random>

#include "common/model/platform.hpp"
#include "common/robot_side/robot_side.hpp"

namespace handsel::sim {

struct OdometrySettings {
  double noise{0.01};       ///< standard deviation of the place after 1 m [m]
  double turn_noise{0.01};  ///< standard deviation of the heading after 1 m or 1 rad [rad]
};

struct LocalisationSettings {
  double rate{10};           ///< [Hz]
  double noise{0.01};        ///< standard deviation of a measured place [m]
  double turn_noise{0.005};  ///< standard deviation of a measured heading [rad]
  double filter_time{0.5};   ///< time constant of the filter of what is measured [s]
};

/// A place in the plane: x, y [m] and heading [rad].
using Place = Vector3;

class PlatformOdometry {
 public:
  /// `robot` drives. `start`: all axes; odometry frame and root frame are one then.
  PlatformOdometry(const RobotModel& robot, const Vector& start, const OdometrySettings& odometry,
                   const LocalisationSettings& localisation, std::uint64_t seed);

  /// Takes over where the platform is after a step: all axes in the root frame; `now` [s].
  void advance(const Vector& position, double now);
  /// Converts what the robot side asks for, in the odometry frame, to the root frame.
  void to_root(Vector& position, Vector& velocity, Vector& acceleration) const;
  /// Returns all axes as the robot side measures them: in the odometry frame.
  Vector measured_position(const Vector& position) const;
  /// Returns the velocities of all axes in the odometry frame.
  Vector measured_velocity(const Vector& velocity) const;
  /// Returns the localised root of the odometry frame in the root frame.
  Pose T_root_odometry() const;
  /// Returns the time since the localisation last found the robot [s].
  double age(double now) const { return now - found_; }

  /// Loses the robot until then [s].
  void lose(double until) { lost_until_ = until; }
  /// Shifts what the localisation finds from now on along x [m].
  void shift(double distance) { shift_ = distance; }
  /// Slips: from now on the wheels roll on by this without the platform, half as far again as they
  /// drive [m].
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
  Place actual_, measured_;        // of the platform: in the root frame, in the odometry frame
  Place offset_;                   // of the odometry frame in the root frame
  Place estimate_{Place::Zero()};  // of the same, by localisation
  double next_{0}, found_{0}, lost_until_{0}, shift_{0}, to_slip_{0};
};

}  // namespace handsel::sim
