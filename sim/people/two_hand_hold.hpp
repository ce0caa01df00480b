// SPDX-License-Identifier: Apache-2.0
// Both hands of a person on one object: a grip of limited force at each hand, which acts on the
// point of the object in that hand. Own method: forces at points apart bear the lever of the load,
// so the wrists bear little of it.
#pragma once

#include <array>

#include "sim/physics/grip.hpp"

namespace handsel::sim {

class TwoHandHold {
 public:
  /// `settings`: of each hand.
  explicit TwoHandHold(const GripSettings& settings) : grips_{Grip(settings), Grip(settings)} {}

  /// Begins to hold an object where it is; poses of the hands and of the object's centre of mass in
  /// the world.
  void hold(const std::array<Pose, 2>& T_world_hand, const Pose& T_world_object);
  /// Ends the hold; the wrenches are zero then.
  void release();
  /// Returns whether both hands hold the object.
  bool holding() const { return grips_[0].holding() && grips_[1].holding(); }
  /// Computes the wrenches for the next step of length dt [s]; a hand that breaks loose ends the
  /// hold. `mass` [kg], `inertia`: min principal moment of the object [kg m^2].
  void update(const std::array<BodyState, 2>& hands, const BodyState& object, double mass,
              double inertia, double dt);
  /// Returns the last wrench on the object about its centre of mass, world axes.
  const Wrench& on_object() const { return on_object_; }
  /// Returns the last wrench on a hand about its origin, world axes; 0 left, 1 right.
  const Wrench& on_hand(int side) const { return on_hands_[side]; }

 private:
  std::array<Grip, 2> grips_;
  std::array<Pose, 2> T_object_hand_{Pose::Identity(), Pose::Identity()};
  Wrench on_object_;
  std::array<Wrench, 2> on_hands_;
};

}  // namespace handsel::sim
