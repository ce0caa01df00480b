// SPDX-License-Identifier: Apache-2.0
// The robot's side of the set-points: drive modes, the check of every set-point, the watch over
// their timing, the jerk-limited stop. In the simulator it is the robot's own controller; in front
// of a real robot (deploy/drivers) it stands between the wire and the maker's controller. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/robot.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/setpoint_filter.hpp"
#include "common/trajectory/setpoint_gate.hpp"
#include "common/trajectory/stop.hpp"

namespace handsel {

struct RobotSideSettings {
  /// Of the controller's set-points [s]; 0: set-points are not checked (tests of the physics
  /// alone).
  double period{0.0};
  double max_gap{0.020};  ///< without set-points for this long while enabled: jerk-limited stop [s]
  /// Set-points at rest and this near the held or measured configuration are followed again after a
  /// stop [rad].
  double resume_tolerance{0.02};
  /// The same for finger axes, which a held object deflects and a person may move [rad; at
  /// `hand_lever` m].
  double resume_hand{0.3};
  double hand_lever{0.05};  ///< of a finger that slides [m]
  double max_ahead{0.020};  ///< a set-point may come this much earlier than its time [s]
  int resume_count{10};     ///< that many of them in a row
  double min_stop{0.5};     ///< shortest time of a protective stop [s]
  /// Longest time that missing set-points may cover [s]: the clock of a stalled reader may stop.
  double max_missing{0.1};
};

/// Starts enabled, holding `start`; the watch begins with the first set-point. Every set-point is
/// checked against the guard limits of the robot description, whatever its source; when one fails,
/// the reference makes a jerk-limited stop and refusal() gives the reason. When set-points stay
/// away the drives stay enabled: the reference makes a jerk-limited stop, too. It follows again by
/// itself once set-points rest near the reference or near the measured configuration: it moves to
/// them first, without a jump. A protective stop, and brakes, end by themselves under the same
/// condition; the permission to move is another matter, and after a protective stop a person's. A
/// user stop ends by enable().
class RobotSide {
 public:
  RobotSide(const RobotModel&, const Vector& start, const RobotSideSettings&);

  /// Processes a set-point. Returns false when it is not followed: wrong dimension, not enabled,
  /// not continuous with the held configuration, or refused. `now`: time [s]; `arrival`: time of
  /// arrival, by a clock that never stops [s].
  bool command(const JointCommand&, double now, double arrival);
  /// The same with one clock for both times.
  bool command(const JointCommand& set_point, double now) { return command(set_point, now, now); }
  /// Sets the measured configuration, all axes [rad] ([m]).
  void measured(const Vector& position) { measured_ = position; }
  /// Makes a jerk-limited stop and enters mode user_stop, which enable() ends.
  void user_stop() { stop(DriveMode::user_stop); }
  /// Enters `mode`; when enabled before, with a jerk-limited stop from the present state of the
  /// reference.
  void stop(DriveMode mode);
  /// Sets the reference to `position`, at rest (brakes, stops of the maker's own), and enters
  /// `mode`.
  void hold(const Vector& position, DriveMode mode);
  /// Enters mode enabled, clears refusal() and follows set-points again, the first at the
  /// reference.
  void enable();
  /// Advances the reference the servos follow to `now`.
  void step(double now, double dt);

  /// Reference of the servos, all axes [rad] ([m]).
  const Vector& position() const { return position_; }
  const Vector& velocity() const { return velocity_; }  ///< of the reference [rad/s] ([m/s])
  /// Of the reference [rad/s^2] ([m/s^2]).
  const Vector& acceleration() const { return acceleration_; }
  /// Feed-forward [Nm] ([N]); kept through a stop, so that an object stays held.
  const Vector& effort() const { return effort_; }
  /// Returns the commanded payload of a hand, numbered as in common/model/manipulator [kg]; 0 when
  /// unknown.
  double payload(std::size_t hand = 0) const;
  /// Writes what the servos follow or hold.
  void report(ServoReference& out) const;
  /// Returns the mode entered last; enabled at the start.
  DriveMode mode() const { return mode_; }
  /// Returns true once a stop has ended: the reference holds, or joins resting set-points.
  bool stopped() const { return reference_ == Reference::stands; }
  /// Returns true when set-points are followed, or would be if they came.
  bool follows() const { return reference_ == Reference::follows; }
  /// Returns in one sentence why set-points are not followed though the drives are enabled; else
  /// empty.
  const std::string& refusal() const { return refusal_; }
  std::uint64_t refused() const { return refused_; }  ///< set-points refused while it followed

 private:
  enum class Reference : char { follows, stops, stands };
  void enter(DriveMode);
  void begin_stop(DriveMode);
  bool continues(const JointCommand&, double max_speed) const;
  bool reached(const JointCommand&) const;
  bool rests() const;
  bool accepted(const JointCommand&, double arrival);
  void refuse(const SetpointRefusal&);
  void step_stop(double dt);
  void extrapolate(double dt);

  RobotSideSettings settings_;
  const RobotModel& model_;
  KinematicLimits limits_;
  SetpointGate gate_;
  std::vector<int> hand_axes_;
  Vector tolerance_;  // of each axis, within which set-points are followed again [rad, m]
  DriveMode mode_{DriveMode::enabled};
  Reference reference_{Reference::follows};
  std::string refusal_;
  Vector position_, velocity_, acceleration_, effort_, measured_;
  std::vector<JerkLimitedStop> stops_;
  std::vector<SetpointFilter> joins_;  // from the held reference to set-points that rest near it
  Vector joined_;                      // configuration of those set-points
  bool seen_{false}, fresh_{false};
  double last_{0}, payload_{0};
  double in_mode_{0};  // since mode_ was entered [s]
  Vector other_payloads_;
  int matching_{0};
  std::uint64_t refused_{0};
};

}  // namespace handsel
