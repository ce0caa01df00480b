// SPDX-License-Identifier: Apache-2.0
// The guard: decides last how fast the running trajectory may continue, from the robot's motion,
// the people around it and the walls it must not pass. One pure function, no state. Speed and
// separation after ISO/TS 15066 with the jerk-limited minimum-time stop. Own method: the
// textbook form, reference_speed(), assumes a constant deceleration.
#pragma once

#include <vector>

#include "common/trajectory/trajectory.hpp"
#include "components/trajectory_controller/input/person_capsules.hpp"
#include "components/trajectory_controller/supervise/path_motion.hpp"

namespace handsel::trajectory_controller {

/// Parameters of speed and separation monitoring, named as in ISO/TS 15066.
struct GuardSettings {
  double speed_floor{0.10};        ///< min v_h assumed of a tracked person [m/s]
  double speed_uncertainty{0.05};  ///< added to the measured directed speed [m/s]
  double speed_unknown{1.6};       ///< v_h of a person not seen just now [m/s]
  double speed_max{2.2};           ///< max v_h [m/s]
  double unknown_after{0.25};      ///< a person not seen for longer moves at speed_unknown [s]
  double reaction{0.06};           ///< T_r without the age of the data: cycle, transport, drive [s]
  double intrusion{0.03};          ///< C [m]
  double uncertainty_human{0.03};  ///< Z_d [m]
  double uncertainty_robot{0.01};  ///< Z_r [m]
  double uncovered_factor{0.3};    ///< speed factor while "nobody" is not a fact
  double handover_speed{0.25};     ///< largest speed toward an exempt forearm or hand [m/s]
  double handover_range{0.30};     ///< within this distance [m]
  double sideways_ratio{0.05};     ///< min closing speed of a link, ratio to its speed
  double away_ratio{0.5};          ///< a link with more than this ratio of its speed leads away
  double stop_persistence{0.15};   ///< too near and still closing in for this long: Stop [s]
  /// Fingers stop for a person only when that person comes toward the hand this fast [m/s].
  double finger_stop_speed{0.10};
};

/// A half space the moving links stay in: normal . p >= offset.
struct Wall {
  Vector3 normal{Vector3::UnitX()};  ///< unit, pointing inward, world axes
  double offset{};                   ///< [m]
};

/// Result of guard().
struct GuardVerdict {
  double forward{1.0};    ///< max speed factor allowed, [0, 1]
  double backward{-1.0};  ///< min speed factor allowed (back along the path), [-1, 0]
  double distance{1e9};   ///< to the nearest person, without exempt parts [m]
  double needed{};        ///< protective separation distance there at the present factor [m]
  int link{-1};           ///< of the robot, nearest to a person; -1: no person is present
  /// Points on the axes of the two nearest capsules, world [m].
  Vector3 on_robot{Vector3::Zero()}, on_person{Vector3::Zero()};
  double view{1.0};           ///< largest factor at which a stop stays inside the observed space
  bool separation{};          ///< speed and separation monitoring limits a factor
  bool wall{};                ///< a wall limits a factor
  bool uncovered{};           ///< no person is observed, but absence is not certain
  bool too_near{};            ///< nearer than a stop at the present factor needs, still closing in
  bool handover_clear{true};  ///< no exempt part within handover_range
};

/// What guard() compares.
struct GuardQuery {
  const std::vector<LinkCapsule>& robot;  ///< capsules of the robot
  const PathMotion& motion;               ///< of the robot, at full speed
  const StopTable& stop;                  ///< of `motion`
  const Pose& T_world_base;               ///< base of the robot in the world
  const PersonCapsules& people;           ///< around the robot
  const std::vector<Wall>& walls;         ///< never passed
  double age{};                           ///< of the human data [s]
  double factor{1.0};                     ///< speed factor in force, [-1, 1]
};

/// Returns the speed v_h at which a part of a person may move along `toward_robot`, a unit vector
/// [m/s].
double directed_speed(const PersonCapsule& part, const Vector3& toward_robot,
                      const GuardSettings& settings) noexcept;

/// Returns the limits of speed and separation monitoring (SSM, ISO 10218-2:2025) and of the walls.
/// Allocates nothing.
GuardVerdict guard(const GuardSettings& settings, const GuardQuery& query) noexcept;

/// Permitted robot speed with constant deceleration, the textbook form: a reference for tests, not
/// the rule used [m/s].
double reference_speed(double separation, double v_h, double reaction, double deceleration,
                       double margin) noexcept;

}  // namespace handsel::trajectory_controller
