// The robot's side of the set-points: drive modes, the check of every set-point, the watch over their pace, the soft stop. In the simulator
// it is the robot's own controller; in front of a real one (deploy/drivers) it stands between the wire and the maker's controller. Pure.
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
  double period{0.0};             ///< of the controller's set-points [s]; 0: set-points are not checked (tests of the physics alone)
  double max_gap{0.020};          ///< without set-points for this long while enabled: soft stop [s]
  double resume_tolerance{0.02};  ///< set-points this near the held or measured posture, at rest, are followed again after a stop [rad]
  double resume_hand{0.3};        ///< instead, of the fingers, which what they hold bends and a person may move [rad; at `hand_lever` m]
  double hand_lever{0.05};        ///< of a finger that slides [m]
  double max_ahead{0.020};        ///< a set-point may come this much earlier than its time [s]
  int resume_count{10};           ///< that many of them in a row
  double min_stop{0.5};           ///< shortest time of a protective stop [s]
  double max_missing{0.1};        ///< longest time that missing set-points may stand for [s]: a stalled reader's own clock may stand still
};

/// Starts enabled, holding `start`; the watch begins with the first set-point. Every set-point is checked against the guard limits of the
/// robot description, whoever sent it; when one fails, the reference stops softly and refusal() says why. When set-points stay away the
/// drives stay enabled: the reference stops softly, too. It follows again by itself once set-points rest near the reference or near the
/// measured posture: it moves to them first, without a jump. A protective stop, and brakes, end by themselves under the same
/// condition; the permission to move is another matter, and after a protective stop a person's. A user stop ends by enable().
class RobotSide {
 public:
  RobotSide(const RobotModel&, const Vector& start, const RobotSideSettings&);

  /// A set-point is there. False when it is not followed: wrong dimension, not enabled, not continuing from the held posture, refused.
  /// `arrival`: when it arrived, by a clock that never stands still [s].
  bool command(const JointCommand&, double now, double arrival);
  bool command(const JointCommand& set_point, double now) { return command(set_point, now, now); }
  /// Where the robot was measured, all axes.
  void measured(const Vector& position) { measured_ = position; }
  void user_stop() { stop(DriveMode::user_stop); }
  /// Softly, from whatever the reference does now; stays in `mode`.
  void stop(DriveMode mode);
  /// The reference is where the robot stands, at rest (brakes, stops of the maker's own); stays in `mode`.
  void hold(const Vector& position, DriveMode mode);
  void enable();
  /// Advances the reference the servos follow to `now`.
  void step(double now, double dt);

  const Vector& position() const { return position_; }
  const Vector& velocity() const { return velocity_; }
  const Vector& acceleration() const { return acceleration_; }
  const Vector& effort() const { return effort_; }  ///< kept through a stop: what is held stays held
  /// Mass told to be in the hand, hands as common/model/manipulator has them [kg].
  double payload(std::size_t hand = 0) const;
  /// Writes what the servos follow or hold.
  void report(ServoReference& out) const;
  DriveMode mode() const { return mode_; }
  bool stopped() const { return reference_ == Reference::stands; }
  bool follows() const { return reference_ == Reference::follows; }  ///< set-points, or would when they come
  /// Why it does not follow though the drives are enabled, one sentence; else empty.
  const std::string& refusal() const { return refusal_; }
  std::uint64_t refused() const { return refused_; }  ///< set-points refused while it followed

 private:
  enum class Reference : char { follows, stops, stands };
  void enter(DriveMode);
  void begin_stop(DriveMode);
  bool continues(const JointCommand&, double max_speed) const;
  bool reached(const JointCommand&) const;
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
  std::vector<SoftStop> stops_;
  std::vector<SetpointFilter> joins_;  // from where it stands to set-points that rest near there
  Vector joined_;                      // the posture of those set-points
  bool seen_{false}, fresh_{false};
  double last_{0}, payload_{0};
  double in_mode_{0};  // since mode_ was entered [s]
  Vector other_payloads_;
  int matching_{0};
  std::uint64_t refused_{0};
};

}  // namespace handsel
