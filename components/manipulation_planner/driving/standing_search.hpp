// SPDX-License-Identifier: Apache-2.0
// Where the platform may stand so that the arm serves a person or a surface. Own method; the costs
// of people are those of chapter section 4.1. Pure.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/collision/platform_places.hpp"
#include "common/config/settings/manipulation_planner.hpp"
#include "common/cost/navigation_cost.hpp"
#include "common/messages/world.hpp"

namespace handsel::manipulation_planner {

/// What the arm is to reach.
struct StandingTarget {
  std::vector<Vector3> points;  ///< world; any of them serves [m]
  /// Of a person who is served: the platform stands before them; level unit vector, world.
  std::optional<Vector3> front;
};

/// A place of the platform.
struct StandingPlace {
  Vector3 place{Vector3::Zero()};  ///< x, y [m], heading [rad] in the root frame of the robot
  Pose T_world_platform{Pose::Identity()};  ///< the same in the world
  double cost{};  ///< weighted sum of the drive, the turn away from the target, and people's costs
};

/// The robot, and what it must heed.
struct StandingQuery {
  const RobotModel& robot;       ///< drives
  const Group& arm;              ///< that is to reach
  const Vector& q;               ///< all axes [rad, m]
  const Pose& T_world_root;      ///< root of the model, level
  const NavigationCost& people;  ///< as the platform's costs are set, in the root frame
};

/// Result of a search.
struct StandingSearch {
  std::vector<StandingPlace> places;  ///< the cheapest first, at most `standing_places`
  Refusals refusals;                  ///< how many places were refused, and why
};

/// Returns whether a place serves; null: all do.
using ServesFrom = std::function<bool(const StandingPlace&)>;

/// Searches places from which the arm reaches a point of the target by its length, where the robot
/// is free of collisions, and which serve; at most `standing_checks` of these are asked about.
StandingSearch find_standing_places(const StandingQuery& query, const StandingTarget& target,
                                    PlatformFloor& floor,
                                    const settings::ManipulationPlannerSettings& settings,
                                    const ServesFrom& serves = nullptr);

}  // namespace handsel::manipulation_planner
