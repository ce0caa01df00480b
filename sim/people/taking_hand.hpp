// SPDX-License-Identifier: Apache-2.0
// The hand of a person on an object: the choice of a place, the approach with an open hand, the
// digits that close. Own method.
#pragma once

#include <optional>

#include "sim/people/free_grasp.hpp"

namespace handsel::sim {

/// Orientation and digits of a hand.
struct HandConfiguration {
  Eigen::Quaterniond R_world_hand{Eigen::Quaterniond::Identity()};  ///< as in HumanHand
  Closures closures{};                                              ///< of the digits
};

class TakingHand {
 public:
  /// Continues the choice of a place for the hand of `query.arm`; begins anew after a choice
  /// without a place, or for the other hand.
  void choose(const FreeGraspQuery& query, const HumanHand& shape,
              const FreeGraspSettings& settings);
  /// Chooses a place at once, for a person who holds the object already; returns whether one
  /// exists.
  bool hold(const FreeGraspQuery& query, const HumanHand& shape, const FreeGraspSettings& settings);
  /// Ends the choice and forgets the place.
  void forget();
  /// Returns whether a place is chosen.
  bool has_place() const { return place_.has_value(); }

  /// Returns the pose of the hand in the chosen place, world; a place is chosen.
  Pose goal(const Pose& T_world_object) const { return T_world_object * place_->T_object_hand; }
  /// Returns the position at the fraction s of a reach from `from` [m], on a curve that ends along
  /// the palm's normal; a place is chosen. `curve`: as of behind().
  Vector3 position_at(const Vector3& from, double s, double curve,
                      const Pose& T_world_object) const;
  /// Returns the control point of a curve that leaves `from` [m] against the palm's normal, at the
  /// distance `curve` [m].
  static Vector3 behind(const Vector3& from, double curve, const Eigen::Quaterniond& R_world_hand);
  /// Returns the configuration at the fractions of turning and closing, [0, 1]; a place is chosen.
  HandConfiguration configuration(const Eigen::Quaterniond& R_world_rest, double turned,
                                  double closed, const Pose& T_world_object) const;

 private:
  std::optional<FreeGraspSearch> search_;
  std::optional<FreeGrasp> place_;
  Side side_{Side::right};
};

}  // namespace handsel::sim
