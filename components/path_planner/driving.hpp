// SPDX-License-Identifier: Apache-2.0
// Planning for a mobile robot: the platform alone, or platform and arm as one robot. Pure.
#pragma once

#include "common/collision/collision_world.hpp"
#include "common/model/platform.hpp"
#include "components/path_planner/pose_goals.hpp"
#include "components/path_planner/problem.hpp"

namespace handsel::path_planner {

/// Returns whether the group contains the axes of a platform.
bool is_of_platform(const std::string& group);

/// Completes a problem with axes of the platform: human-aware cost of the platform, bounds around
/// start and goals with the margin `roam` [m], headings of goals nearest to the start's. `mobile`:
/// the robot on its platform (on_platform).
void drive(const RobotModel& mobile, const NavigationCost& cost, double roam, Problem& problem);

/// Horizontal clearance of a platform from furniture.
struct FurnitureRoom {
  double room{};  ///< clearance [m]
  /// Clearance at a nearer start or goal, divided by its distance; < 1, because the corners of a
  /// turned box approach faster than its sides.
  double fraction_at_ends{0.6};
};

/// Replaces the scene of a world, after moving axes and attachment: furniture is enlarged by `room`
/// on every horizontal side, or by less if a configuration of `ends` (all axes) is nearer to a box,
/// because the platform must be able to start and stop beside furniture.
void keep_clear_of_furniture(CollisionWorld& world, const Scene& scene, const FurnitureRoom& room,
                             const std::vector<Vector>& ends);

/// Random platform poses that are tried for each pose of the tip.
struct PlatformSampling {
  int tries{1500};           ///< number of these
  double max_distance{1.2};  ///< max horizontal distance of these from the pose [m]
  int each{4};               ///< configurations after which the search ends
};

/// Returns configurations of the whole robot for each pose: random platform poses around it,
/// nearest to the start first, from which the arm reaches the pose with all other axes as in
/// q_start; free of collisions with bodies at rest.
PoseGoals reach_with_platform(const RobotModel& mobile, CollisionWorld& world,
                              const std::vector<PoseGoal>& poses, const Vector& q_start,
                              std::uint64_t seed, const PlatformSampling& sampling = {});

}  // namespace handsel::path_planner
