// The robot's side of the set-points: drive modes, the watch over set-points, the soft stop. In the simulator it is the robot's own
// controller; in front of a real one (deploy/drivers) it stands between the wire and the maker's controller. Pure.
#pragma once

#include <vector>

#include "common/messages/robot.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/stop.hpp"

namespace handsel::sim {

struct RobotSideSettings {
  double max_gap{0.020};          ///< without set-points for this long while enabled: soft stop [s]
  double resume_tolerance{0.02};  ///< set-points this near the held posture, at rest, end a protective stop [rad]
  int resume_count{10};           ///< that many of them in a row
  bool never_releases{false};     ///< a mutant: the hand's set-points are ignored once it holds something and has rested for half a second
};

/// Starts enabled, holding `start`; the watch begins with the first set-point. A protective stop ends by itself when set-points come
/// again that continue from the held posture; a user stop ends by enable().
class RobotSide {
 public:
  RobotSide(const RobotModel&, const Vector& start, const RobotSideSettings&);

  /// A set-point arrived. False when it is not followed: wrong dimension, not enabled, not continuing from the held posture.
  bool command(const JointCommand&, double now);
  void user_stop() { stop(DriveMode::user_stop); }
  /// Softly, from whatever the reference does now; stays in `mode`.
  void stop(DriveMode mode);
  /// The reference is where the robot stands, at rest (brakes, stops of the maker's own); stays in `mode`.
  void hold(const Vector& position, DriveMode mode);
  void enable();
  /// Advances the reference the servos follow to `now`.
  void step(double now, double dt, bool holding_object);

  const Vector& position() const { return position_; }
  const Vector& velocity() const { return velocity_; }
  const Vector& acceleration() const { return acceleration_; }
  const Vector& effort() const { return effort_; }  ///< kept through a stop: what is held stays held
  /// Mass told to be in the hand, hands as common/model/manipulator has them [kg].
  double payload(std::size_t hand = 0) const;
  DriveMode mode() const { return mode_; }
  bool hand_moves() const;  ///< its reference does
  bool stopped() const { return stopping_ && at_rest_; }

 private:
  void begin_stop(DriveMode);

  RobotSideSettings settings_;
  KinematicLimits limits_;
  std::vector<int> hand_axes_;
  DriveMode mode_{DriveMode::enabled};
  Vector position_, velocity_, acceleration_, effort_;
  Vector closed_, squeeze_;  // hand posture and effort kept by the mutant
  std::vector<SoftStop> stops_;
  bool stopping_{false}, at_rest_{false}, seen_{false}, fresh_{false}, clenched_{false};
  double last_{0}, hand_rest_{0}, payload_{0};
  Vector other_payloads_;
  int matching_{0};
};

}  // namespace handsel::sim
