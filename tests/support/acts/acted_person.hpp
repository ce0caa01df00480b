// SPDX-License-Identifier: Apache-2.0
// A person moved by a script of minimum-jerk pieces: feet, facing, hand and gaze. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/world.hpp"

namespace handsel::test {

/// Activity of a person with an object.
enum class Act {
  keeps,       ///< holds the object before the body or beside the leg
  brings_out,  ///< moves the object out to offer it
  offers,      ///< holds the object out for the robot, at rest
  hesitates,   ///< stops midway
  withdraws,   ///< moves the object back
  aborts,      ///< moves the object out and back without a rest
  carries,     ///< walks with the object
  drinks,      ///< holds the object at the mouth
  inspects,    ///< holds the object before the eyes
  gestures,    ///< talks, the hand with the object moves
  puts_down,   ///< places the object on the counter, or picks it up there
  passes,      ///< holds the object out for another person
  points,      ///< points aside with the object in the hand
  receives,    ///< reaches for an object that another person offers
};
const char* name(Act act);  ///< as in the enumeration

/// Gaze target of a person.
enum class Gaze { ahead, object, robot, aside };

/// One piece of a script: all parts move with a minimum-jerk profile to where they end.
struct Piece {
  Act act{};                      ///< activity during the piece
  double duration{};              ///< > 0 [s]
  Vector3 hand{Vector3::Zero()};  ///< end of the hand, in the frame of the feet [m]
  Vector3 step{Vector3::Zero()};  ///< of the feet, world [m]
  double turn{};                  ///< of the facing [rad]
  Gaze gaze{Gaze::ahead};         ///< during the piece
};

/// Body of a scripted person.
class ActedPerson {
 public:
  struct Settings {
    std::string id;                 ///< unique
    Vector3 feet{Vector3::Zero()};  ///< world [m]
    double yaw{};                   ///< facing, 0 = +x [rad]
    double stature{1.75};           ///< [m]
    bool left_handed{};             ///< acts with the left hand
    double sway{0.004};             ///< amplitude of the sway of the trunk [m]
    double tremor{0.001};           ///< amplitude of the motion of a hand at rest [m]
  };
  ActedPerson(const Settings& settings, const Vector3& hand);

  /// Returns the shoulder of the acting hand, in the frame of the feet [m].
  Vector3 shoulder() const;
  /// Returns a joint of the body with hanging arms, in the frame of the feet [m].
  Vector3 joint(const char* name) const;
  /// Returns a world point in the frame of the feet [m].
  Vector3 to_body(const Vector3& p_world) const;
  /// Returns +1 for the left hand, -1 for the right one.
  double side() const { return settings_.left_handed ? 1.0 : -1.0; }
  /// Returns the max distance of the hand from the shoulder [m].
  double reach() const { return 0.97 * (upper_ + lower_ + palm_); }
  /// Returns the facing [rad].
  double yaw() const { return yaw_; }

  /// Begins a piece; it starts where the last one is.
  void begin(const Piece& piece);
  /// Moves to `t` [s] since the begin of the piece and `clock` [s] of the sequence.
  void move(double t, double clock, const Vector3& look_at, double dt);
  /// Returns whether the piece is over at `t` [s] since its begin.
  bool is_over(double t) const { return t >= piece_.duration; }
  /// Returns the act of the present piece.
  Act act() const { return piece_.act; }
  /// Returns the gaze target.
  Gaze gaze() const { return piece_.gaze; }

  const Person& body() const { return body_; }  ///< ground truth, without velocities
  Pose T_world_hand() const;                    ///< axes turn with the body

 private:
  void bend_arm(const Vector3& target);

  Settings settings_;
  std::vector<BodyJoint> template_;  // at the origin, facing +x
  double upper_{}, lower_{}, palm_{};
  Piece piece_;
  Vector3 feet_, feet_from_, hand_, hand_from_;
  double yaw_, yaw_from_;
  Person body_;
};

}  // namespace handsel::test
