// Where a giver who keeps moving holds an object, as the giver of the set t0 of GenH2R (Wang et
// al., CVPR 2024) does: along curves from point to point, turning, until the time is over. Own
// method: the points are in reach of an arm, and the hand turns as far as a wrist does. Pure.
#pragma once

#include <cstdint>
#include <random>

#include "common/geometry/pose.hpp"

namespace handsel::sim {

struct MovingOfferSettings {
  double duration{};                      ///< of the motion [s]; 0: none
  Vector3 start_low{Vector3::Zero()};     ///< box of the start, world [m] ...
  Vector3 start_high{Vector3::Zero()};    ///< ... to this corner [m]
  Vector3 next_low{Vector3::Zero()};      ///< box of the next points, world [m] ...
  Vector3 next_high{Vector3::Zero()};     ///< ... to this corner [m]
  double spread{};                        ///< deviation of a key point from the middle [m]
  double slowest{}, fastest{};            ///< bounds of the speed of a piece [m/s]
  double slowest_turn{}, fastest_turn{};  ///< bounds of the angular speed of a piece [rad/s]
  double max_turn{};                      ///< from the middle configuration of the wrist [rad]
  double waits_within{};                  ///< of the robot's fingertips from the object [m]
  std::uint64_t seed{};                   ///< of all that is drawn
};

/// What an arm reaches: the part of a ball about the shoulder that lies before the body.
struct ArmReach {
  Vector3 p_shoulder{Vector3::Zero()};    ///< world [m]
  Vector3 forward{Vector3::UnitX()};      ///< of the body, level
  double min_distance{}, max_distance{};  ///< distance from the shoulder [m]
  double before{};                        ///< min distance before the shoulder [m]
  Vector3 p_avoided{Vector3::Zero()};     ///< nothing is offered near here, world [m] ...
  double avoided{};                       ///< ... within this distance [m]
  /// Returns whether the arm reaches the point.
  bool contains(const Vector3& p_world) const;
};

class MovingOffer {
 public:
  /// Draws the start: in its box and in reach, else `otherwise`.
  MovingOffer(const MovingOfferSettings& settings, const ArmReach& reach, const Vector3& otherwise);

  /// Advances by dt [s]; a giver who waits stays where they are.
  void step(double dt, bool waits);
  /// Returns where the object is held, world [m].
  const Vector3& position() const { return p_; }
  /// Returns by how much the hand is turned from the middle configuration of the wrist.
  const Eigen::Quaterniond& turn() const { return turn_; }
  /// Returns whether the motion is over: the object stays where it is.
  bool is_over() const { return moved_for_ >= settings_.duration; }

 private:
  Vector3 draw(const Vector3& low, const Vector3& high, const Vector3& otherwise);
  Vector3 any_direction();
  double within(double low, double high);
  void begin_piece();
  Vector3 curve(double u) const;
  void move_on(double length);
  void turn_on(double angle);

  MovingOfferSettings settings_;
  ArmReach reach_;
  std::mt19937_64 random_;
  Vector3 p_{Vector3::Zero()};
  Eigen::Quaterniond turn_{Eigen::Quaterniond::Identity()};
  Vector3 from_{Vector3::Zero()}, key_{Vector3::Zero()}, to_{Vector3::Zero()};  // of the piece
  double along_{};                                                              // of it, 0 to 1
  double speed_{}, turn_speed_{};                                               // [m/s], [rad/s]
  Vector3 axis_{Vector3::UnitX()};
  double moved_for_{};  // [s]
};

}  // namespace handsel::sim
