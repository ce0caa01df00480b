// Planning for a robot whose platform drives: alone, or with its arm as one robot. Pure.
#pragma once

#include "common/collision/collision_world.hpp"
#include "common/model/platform.hpp"
#include "components/path_planner/pose_goals.hpp"
#include "components/path_planner/problem.hpp"

namespace handsel::path_planner {

/// Returns whether the group is one that the axes of a platform add.
bool is_of_platform(const std::string& group);

/// `mobile`: a robot on its platform (on_platform). Completes a problem whose axes are those of a
/// group that drives: people's costs of the platform; room as far as start and goals and `roam` [m]
/// beyond; headings of goals nearest to that of the start.
void drive(const RobotModel& mobile, const NavigationCost& cost, double roam, Problem& problem);

/// Level clearance of a platform from furniture.
struct FurnitureRoom {
  double room{};                 ///< [m]
  double fraction_at_ends{0.6};  ///< of the distance of an end that is nearer; < 1, as growing
                                 ///< sides of a turned box come nearer by more at corners
};

/// Replaces the scene of a world whose moving axes and attachment are set: furniture is larger by
/// `room` on every level side, or by less where a configuration of `ends` (all axes) is nearer to a
/// box: beside a sideboard the platform must be able to stop, and to leave.
void keep_clear_of_furniture(CollisionWorld& world, const Scene& scene, const FurnitureRoom& room,
                             const std::vector<Vector>& ends);

/// Poses for the whole robot: places of the platform around each, drawn at random and as near to
/// where it stands as they come, from which the arm reaches it with the other axes as in q_start;
/// free of collision with what is at rest. Up to `each` a pose.
PoseGoals reach_with_platform(const RobotModel& mobile, CollisionWorld& world,
                              const std::vector<PoseGoal>& poses, const Vector& q_start,
                              std::uint64_t seed, int each = 4);

}  // namespace handsel::path_planner
