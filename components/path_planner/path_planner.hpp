// SPDX-License-Identifier: Apache-2.0
// Plans a path for a problem: straight line, random search, smoothing, final fine check. Pure: no
// clock, no files, no global state; the same problem in the same world gives the same result.
#pragma once

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "components/path_planner/problem.hpp"

namespace handsel::path_planner {

/// Models for planning. The referenced objects must outlive the call.
struct PlanningModels {
  const RobotModel& robot;  ///< Robot that is planned for.
  CollisionWorld& world;    ///< Obstacles and people of that robot.
  HumanCost& cost;          ///< Human-aware cost of that robot.
};

/// Plans a path by RRT-Connect without people, by BiT-RRT on the human-aware cost with people
/// (chapter section 4.1.3), or by the planner that the problem names. World and cost contain robot,
/// scene, people, base and held object. The reason of a failure names the end in collision and its
/// contact, the axis out of its limits, the wrong dimension, or the min distance reached by the
/// search.
Result plan(const RobotModel& robot, CollisionWorld& world, HumanCost& cost, const Problem& problem,
            const Settings& settings, const Hooks& hooks = {});

}  // namespace handsel::path_planner
