// SPDX-License-Identifier: Apache-2.0
// Computes the motion of an offer by a moving giver, as in the set t0 of GenH2R (Wang et al., CVPR
// 2024): curves from point to point with a superposed rotation, for a limited time. Own method: the
// points are within reach of an arm, and the rotation stays within the range of a wrist. Pure.
#pragma once

#include <cstdint>
#include <random>

#include "common/geometry/pose.hpp"

namespace handsel::sim {

struct MovingOfferSettings {
  double duration{};                    ///< duration of the motion [s]; 0: no motion
  Vector3 start_low{Vector3::Zero()};   ///< low corner of the box of the start, world [m]
  Vector3 start_high{Vector3::Zero()};  ///< high corner of the box of the start, world [m]
  Vector3 next_low{Vector3::Zero()};    ///< low corner of the box of the next points, world [m]
  Vector3 next_high{Vector3::Zero()};   ///< high corner of the box of the next points, world [m]
  double spread{};                  ///< standard deviation of a control point from the midpoint [m]
  double min_speed{}, max_speed{};  ///< bounds of the speed on a curve [m/s]
  double min_turn_speed{}, max_turn_speed{};  ///< bounds of the angular speed on a curve [rad/s]
  double max_turn{};      ///< max angle from the neutral wrist configuration [rad]
  double waits_within{};  ///< finger distance below which the giver waits [m]
  std::uint64_t seed{};   ///< seed of all random numbers
};

/// The volume that an arm reaches: the part of a spherical shell about the shoulder in front of the
/// body.
struct ArmReach {
  Vector3 p_shoulder{Vector3::Zero()};    ///< shoulder, world [m]
  Vector3 forward{Vector3::UnitX()};      ///< horizontal direction of the body, world
  double min_distance{}, max_distance{};  ///< bounds of the distance from the shoulder [m]
  double min_before{};                    ///< min distance in front of the shoulder [m]
  Vector3 p_avoided{Vector3::Zero()};     ///< centre of the excluded sphere, world [m]
  double avoided_radius{};                ///< radius of the excluded sphere [m]
  /// Returns whether the arm reaches the point.
  bool contains(const Vector3& p_world) const;
};

class MovingOffer {
 public:
  /// Draws the start in its box and within reach; uses `otherwise` if no draw is within reach.
  MovingOffer(const MovingOfferSettings& settings, const ArmReach& reach, const Vector3& otherwise);

  /// Advances by dt [s]; does nothing while the giver waits.
  void step(double dt, bool waits);
  /// Returns the position of the offer, world [m].
  const Vector3& position() const { return p_; }
  /// Returns the rotation of the hand from the neutral wrist configuration.
  const Eigen::Quaterniond& turn() const { return turn_; }
  /// Returns whether the motion is over and the object at rest.
  bool is_over() const { return moved_for_ >= settings_.duration; }

 private:
  Vector3 draw(const Vector3& low, const Vector3& high, const Vector3& otherwise);
  Vector3 random_direction();
  double draw_uniform(double low, double high);
  void begin_curve();
  Vector3 curve_point(double u) const;
  void advance(double length);
  void turn_by(double angle);

  MovingOfferSettings settings_;
  ArmReach reach_;
  std::mt19937_64 random_;
  Vector3 p_{Vector3::Zero()};
  Eigen::Quaterniond turn_{Eigen::Quaterniond::Identity()};
  Vector3 from_{Vector3::Zero()}, control_point_{Vector3::Zero()},
      to_{Vector3::Zero()};        // of the curve
  double along_{};                 // parameter on the curve, 0 to 1
  double speed_{}, turn_speed_{};  // on this curve [m/s], [rad/s]
  Vector3 axis_{Vector3::UnitX()};
  double moved_for_{};  // duration of the motion so far [s]
};

}  // namespace handsel::sim
