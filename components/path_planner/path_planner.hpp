// From a problem to a path: straight line, random search, smoothing, a last fine check. Pure: no
// clock, no files, no global state; the same problem in the same world gives the same result.
#pragma once

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "components/path_planner/problem.hpp"

namespace handsel::path_planner {

/// What planning needs beside the problem. The referenced objects must outlive the call.
struct PlanningModels {
  const RobotModel& robot;  ///< Robot that is planned for.
  CollisionWorld& world;    ///< Obstacles and people of that robot.
  HumanCost& cost;          ///< Human-aware cost of that robot.
};

/// RRT-Connect where no person is present, BiT-RRT on the human-aware cost where a person is
/// (chapter section 4.1.3), or what the problem names. The world and the cost hold robot, scene,
/// people, base and what the hand carries. A failure says why: which end is in collision and with
/// what, which axis is out of its limits, which dimension is wrong, how near the search came.
Result plan(const RobotModel& robot, CollisionWorld& world, HumanCost& cost, const Problem& problem,
            const Settings& settings, const Hooks& hooks = {});

}  // namespace handsel::path_planner
