// SPDX-License-Identifier: Apache-2.0
// The other hand of a person who takes an object with both hands: reaches a place of its own at the
// same time as the leading hand, then keeps its distance to that hand. Own method. Pure.
#pragma once

#include <optional>

#include "sim/people/taking_hand.hpp"

namespace handsel::sim {

class SecondHand {
 public:
  /// Returns the place of the hand on the object, for its choice.
  TakingHand& taking() { return taking_; }
  /// Returns the place of the hand on the object.
  const TakingHand& taking() const { return taking_; }
  /// Returns whether the hand takes part: from the begin of a reach until it is back at rest.
  bool is_active() const { return active_; }
  /// Returns the position that the hand is moved to, world [m]; only of an active hand.
  const Vector3& target() const { return target_; }
  /// Returns the configuration; nullopt: a fist.
  const std::optional<HandConfiguration>& configuration() const { return configuration_; }

  /// Begins a reach from a position [m] and an orientation of the hand; a place is chosen.
  void begin(const Vector3& from, const Eigen::Quaterniond& R_world_rest);
  /// Moves the hand to the fraction s of the reach. `curve`: as of TakingHand::position_at().
  void reach(double s, double curve, const Pose& T_world_object);
  /// Notes where the hand is seen from the leading hand at `p_leading`, world [m].
  void join(const Vector3& p_leading) { offset_ = target_ - p_leading; }
  /// Moves the hand as the leading hand moves.
  void follow(const Vector3& p_leading) { target_ = p_leading + offset_; }
  /// Returns where the hand is from the leading hand, as of join(), world [m].
  const Vector3& offset() const { return offset_; }
  /// Begins the motion back to rest, against the palm's normal. `curve`: as of
  /// TakingHand::behind().
  void begin_return(double curve);
  /// Moves the hand to the fraction s of the motion to `rest`, world [m]; at 1 it takes part no
  /// more.
  void come_back(double s, const Vector3& rest);
  /// Sets the configuration at fractions of turning and closing, see TakingHand::configuration().
  void configure(double turned, double closed, const Pose& T_world_object);
  /// Opens the digits by this part of their full closure.
  void open(double part);
  /// Makes the hand a fist and forgets its place.
  void forget();

 private:
  TakingHand taking_;
  bool active_{false};
  Vector3 from_{Vector3::Zero()}, target_{Vector3::Zero()}, offset_{Vector3::Zero()};
  std::optional<Vector3> behind_;  // control point of the curve back to rest [m]; nullopt: straight
  Eigen::Quaterniond R_world_rest_{Eigen::Quaterniond::Identity()};
  std::optional<HandConfiguration> configuration_;
};

}  // namespace handsel::sim
