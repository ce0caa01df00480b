// What a platform that drives past people costs them (chapter section 4.1, after Sisbot): safety,
// visibility from behind, and the path ahead of a person that walks. In the plane. Pure.
#pragma once

#include <vector>

#include "common/cost/human_cost.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {

struct NavigationSettings {
  double radius{1.3};         ///< R: nothing beyond this gap between platform and person [m]
  double radius_moving{1.5};  ///< R beside a person that moves [m]
  double moving{0.2};         ///< from this speed on a person counts as moving [m/s]
  double field{M_PI / 4};     ///< within this angle of the gaze the platform is seen [rad]
  double cone{0.5};           ///< half the angle of the cone ahead of a person that moves [rad]
  double cone_time{2.0};      ///< its length beyond R: where they are after this [s]
};

/// (cos(d pi/2R) 0.6/(0.6 + d))^3: 1 at contact (the chapter's h only scales it), 0 from R on.
double platform_safety_cost(double gap, double radius);

class NavigationCost {
 public:
  /// `robot`: with its platform as axes (on_platform). `weights`: of safety and visibility; the
  /// others count nothing here.
  NavigationCost(const RobotModel& robot, const CostSettings& weights,
                 const NavigationSettings& settings = {});
  /// Replaces all people; places, gazes and velocities are taken in the horizontal plane of the
  /// world.
  void set_people(const HumanState& people);
  /// Returns whether at least one person is in the scene; else every cost is 0.
  bool anyone() const { return !someone_.empty(); }
  /// x, y [m] and heading [rad] of the platform in the world; of the person it is worst for,
  /// in [0, 1].
  double operator()(double x, double y, double heading) const;

 private:
  struct Disc {  // a part of the platform seen from above: a segment with round ends
    Eigen::Vector2d a, b;
    double radius;
  };
  struct Someone {
    Eigen::Vector2d place, gaze, velocity;  // gaze: unit
    double body, radius, speed;
  };
  double of(const Someone& one, double gap, const Eigen::Vector2d& to_platform) const;

  NavigationSettings settings_;
  double w_safety_, w_visibility_;
  std::vector<Disc> outline_;
  std::vector<Someone> someone_;
};

}  // namespace handsel
