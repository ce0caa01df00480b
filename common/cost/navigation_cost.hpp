// SPDX-License-Identifier: Apache-2.0
// What a platform that drives past people costs them (chapter section 4.1, after Sisbot): safety,
// visibility from behind, the path ahead of a person that walks, and the space between two people
// who talk (own method). In the plane. Pure.
#pragma once

#include <utility>
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
  double conversation{2.5};   ///< people within this distance who face each other talk [m]
  double facing{M_PI / 4};    ///< each within this angle of the other's gaze [rad]
  double between{0.6};        ///< and nothing beyond this gap to the line between them costs [m]
};

/// (cos(d pi/2R) 0.6/(0.6 + d))^3: 1 at contact (the chapter's h only scales it), 0 from R on.
double platform_safety_cost(double gap, double radius);

class NavigationCost {
 public:
  /// `robot`: with its platform as axes (on_platform). `weights`: of safety and visibility; the
  /// others count nothing here.
  NavigationCost(const RobotModel& robot, const CostSettings& weights,
                 const NavigationSettings& settings = {});
  /// Replaces all people; places, gazes and velocities are taken in the horizontal plane.
  /// `T_world_root`: level root of the robot's model.
  void set_people(const HumanState& people, const Pose& T_world_root = Pose::Identity());
  /// Returns whether at least one person is in the scene; else every cost is 0.
  bool anyone() const { return !someone_.empty(); }
  /// x, y [m] and heading [rad] of the platform in the root frame; of the person it is worst for,
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
  void find_conversations();
  double between_people(const Eigen::Rotation2Dd& turn, const Eigen::Vector2d& place) const;

  NavigationSettings settings_;
  double w_safety_, w_visibility_;
  std::vector<Disc> outline_;
  std::vector<Someone> someone_;
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> conversations_;  // of two people
};

}  // namespace handsel
